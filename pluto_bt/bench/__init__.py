"""Benchmarks: each module measures one part and gives rows; ratios are taken against a baseline in the same run."""
