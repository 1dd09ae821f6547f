"""Files of other programs: plans, calibrations, charts and logs, read and written.

Every reader turns a file into a neutral `Plan`, every writer a `Plan` into a file; `mission_text`
and `mission_plan` are the same for mission files. What becomes of each item stands in a ledger.
"""
