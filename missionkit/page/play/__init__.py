"""A chart that is played with: every quantity that its guards read is set by hand."""
