"""The driver `serial-board`: a microcontroller with many sensors and motors on a serial line."""
