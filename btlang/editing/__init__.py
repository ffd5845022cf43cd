"""Missions as editors need them: what stands where, and changes of their trees as changes of their texts."""
