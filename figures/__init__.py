"""What `bench` and `evaluation` share: figures, their table and their JSON."""
