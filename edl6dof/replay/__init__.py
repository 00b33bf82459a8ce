"""The 3D replay of flights, as a rerun recording with its own arrangement of views."""
