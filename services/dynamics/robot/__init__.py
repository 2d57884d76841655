"""What a robot has to bear while it holds a handle that pushes back."""
