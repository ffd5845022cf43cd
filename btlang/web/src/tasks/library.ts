// The missions in the library of a robot.
import { request } from "../api";

/** A mission that is kept: how often it was, and by whom at last. */
export interface LibraryMission {
  name: string;
  number: number;
  person: string;
}

const asked = new Map<string, Promise<LibraryMission[]>>(); // and not answered yet

/** Those of a robot, by default of the first; whoever asks before the answer gets the same one. Throws RequestError. */
export function libraryOf(robot: string): Promise<LibraryMission[]> {
  const path = `/api/missions${robot && `?robot=${encodeURIComponent(robot)}`}`;
  const under = asked.get(path) ?? request("GET", path).then(({ data }) => data.missions).finally(() => asked.delete(path));
  asked.set(path, under);
  return under;
}
