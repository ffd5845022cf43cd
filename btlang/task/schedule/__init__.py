"""When schedules are due: rules in English, the calendar and time zones."""
