"""Integrators in C around a compiled model: fixed-step Runge-Kutta, generalised-alpha, IDA of SUNDIALS."""
