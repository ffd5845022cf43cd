"""The parts of a robot that ship as components: base, sensors, joints, hands, voice and hearing over devices."""
