"""The free flyer's navigator: radio ranges, a gyroscope and feature points, in two tandem filters.

Source: P3 sections II to IV; `compound_ekf` is the same filter with one covariance.
"""
