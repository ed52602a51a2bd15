"""A calibration coupon: printed once and measured, it says what [print] has to be."""
