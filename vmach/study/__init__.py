"""Studies of many cases: machines x programs x draws x variants, on all cores or on a cluster."""
