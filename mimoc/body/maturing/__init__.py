"""The law `maturing`: how strength, passive joints, ranges and masses differ from those at 18 months."""
