"""The task layer: many missions for one robot, with a queue, schedules, interruptions and a memory."""
