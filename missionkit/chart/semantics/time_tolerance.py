"""How nearly two times are the same."""

EPSILON = 1e-9  # s; ticks are multiples of the period, up to rounding
