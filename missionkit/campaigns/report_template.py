"""The frame of the report: one page that needs nothing beside itself."""

from __future__ import annotations

from string import Template

PAGE = Template(
    """\
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>$title</title>
<style>
body { font: 16px/1.5 system-ui, "Helvetica Neue", Arial, sans-serif; color: #1f2933;
  max-width: 1000px; margin: 2rem auto; padding: 0 1.2rem; background: #fff; }
h1 { font-size: 1.7rem; margin: 0; } h2 { font-size: 1.2rem; margin: 2.4rem 0 .5rem; }
h3 { font-size: 1rem; margin: 1.4rem 0 .3rem; }
.sub { color: #6b7785; margin: .1rem 0 1.2rem; }
.verdict { border-left: 6px solid $colour; background: #f5f7f9; padding: .7rem 1.1rem; }
.verdict p { margin: .3rem 0; } .big { font-size: 1.35rem; font-weight: 600; }
table { border-collapse: collapse; width: 100%; font-size: .92rem; }
table + table { margin-top: 1rem; }
th, td { text-align: left; padding: .3rem .7rem .3rem 0; border-bottom: 1px solid #e4e7eb;
  vertical-align: top; }
th { color: #6b7785; font-weight: 600; } td.n, th.n { text-align: right; }
td.n { font-variant-numeric: tabular-nums; white-space: nowrap; }
.soft { color: #6b7785; } .small { font-size: .88rem; }
.row { display: flex; flex-wrap: wrap; gap: .4rem 1rem; }
figure { margin: .6rem 0; } figcaption { font-size: .85rem; color: #6b7785; }
svg { max-width: 100%; height: auto; }
.wide { overflow-x: auto; } .wide svg { max-width: none; }
code { font-size: .82rem; background: #f5f7f9; padding: .1rem .3rem; overflow-wrap: anywhere; }
.good { color: #007a59; } .bad { color: #b34d00; } details { margin: .8rem 0; }
summary { cursor: pointer; font-weight: 600; }
@media print { body { max-width: none; margin: 0; } .wide svg { max-width: 100%; } }
</style>
</head>
<body>
<h1>$title</h1>
<p class="sub">$sub</p>
$body
</body>
</html>
"""
)
