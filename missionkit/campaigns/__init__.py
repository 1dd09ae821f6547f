"""Many runs of one mission: flown in parallel, counted, analysed, told on a page."""
