"""Models as functions of CasADi, and as models of acados."""
