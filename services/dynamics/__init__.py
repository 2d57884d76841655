"""Physics that pushes back: Φ of D_artic_dyn, and what it asks of a robot."""
