"""Markov chains and decision processes of a few states; knows nothing of missions."""
