"""Many runs of one mission: flown in parallel, counted, analysed, reported on a page."""
