"""The elastic catenary through the instantaneous ends, and how wrong it is: a cable without inertia."""
