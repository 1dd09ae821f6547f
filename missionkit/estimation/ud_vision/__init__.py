"""The vision-aided inertial navigator: features of the ground as states, on U D Uᵀ factors."""
