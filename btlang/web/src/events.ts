// What happens on a robot. Made from btlang/run/events.py by `python -m tests.generate`.

/** Messages leave out fields that have their defaults; see `whole`. */
export type RunEvent = { t: number; run: string; number: number; wall: number; } & (
  | { event: "say"; text: string; } // Said
  | { event: "print"; text: string; } // Printed
  | { event: "choose"; type: string; how: string; name: string; seed: number | null; } // Chosen
  | { event: "navigate"; name: string; } // NavigationStarted
  | { event: "arrive"; name: string; } // Arrived
  | { event: "bump"; into: string; } // Bumped
  | { event: "stuck"; } // Stuck
  | { event: "stop"; } // Stopped
  | { event: "grasp"; hand: string; name: string; } // Grasped
  | { event: "release"; hand: string; name: string | null; } // Released
  | { event: "drop"; hand: string; name: string | null; } // Dropped
  | { event: "joint"; targets: Record<string, number>; } // JointsMoved
  | { event: "dock"; } // Docked
  | { event: "undock"; } // Undocked
  | { event: "battery"; percent: number; } // BatteryEmpty
  | { event: "fault"; kind: string; text: string; } // FaultInjected
  | { event: "hear"; text: string; who: string; } // Heard
  | { event: "ask"; text: string; who: string; } // Asked
  | { event: "see"; name: string; } // Seen
  | { event: "come"; name: string; } // Came
  | { event: "leave"; name: string; } // Gone
  | { event: "call"; text: string; } // Called
  | { event: "door"; name: string; open: boolean; } // DoorMoved
  | { event: "switch"; name: string; on: boolean; } // Switched
  | { event: "give"; hand: string; name: string; who: string; } // Given
  | { event: "picture"; name: string; } // Pictured
  | { event: "language"; name: string; } // LanguageChosen
  | { event: "stroke"; name: string; stroke: number; word: number; } // StrokePlanned
  | { event: "gesture"; name: string; slower: number; } // GestureStarted
  | { event: "part"; kind: string; name: string; state: string; text: string; } // PartChanged
  | { event: "warning"; text: string; path: string; place: string; } // Warned
  | { event: "error"; text: string; path: string; place: string; } // Troubled
  | { event: "robot"; kind: string; data: Record<string, unknown>; } // RobotEvent
  | { event: "overrun"; seconds: number; period: number; path: string; id?: string; name?: string; ports?: Record<string, string>; leaf_seconds: number; } // Overrun
  | { event: "end"; outcome: string; stopped: string; seconds: number; still: boolean | null; motion: string; path: string; id: string; reason: string; place: string; } // Ended
);

/** The defaults of fields by the kinds of events. */
export const DEFAULTS: Partial<Record<string, Record<string, unknown>>> = {
  choose: {"seed": null},
  gesture: {"slower": 1.0},
  part: {"text": ""},
  warning: {"path": "", "place": ""},
  error: {"path": "", "place": ""},
  overrun: {"path": "", "leaf_seconds": 0.0},
  end: {"motion": "", "path": "", "id": "", "reason": "", "place": ""},
};

/** The kinds of events that say that something is wrong. */
export const ALARMS: ReadonlySet<string> = new Set<RunEvent["event"]>(["bump", "stuck", "drop", "battery", "fault", "warning", "error"]);

/** An event with all its fields, from one without those that have their defaults. */
export function whole(event: { event: string }): RunEvent {
  return { ...DEFAULTS[event.event], ...event } as RunEvent;
}
