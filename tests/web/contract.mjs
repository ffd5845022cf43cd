// The reducer of the page and its words for events, outside of a browser: prints what it makes of the cases in a file.
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [folder, file] = process.argv.slice(2);
const { lists, events, steps } = JSON.parse(readFileSync(file, "utf8"));
let language = "en";
globalThis.localStorage = { getItem: () => language };
const { Robot } = await import(pathToFileURL(`${folder}/fleet.js`));
const { inWords } = await import(pathToFileURL(`${folder}/log.js`));
const { whole } = await import(pathToFileURL(`${folder}/events.js`));

const plain = (run) => run && { id: run.id, task: run.task, statuses: run.statuses, words: run.nodes.map(([, , words]) => words) };
const states = lists.map((messages) => {
  const robot = new Robot("robot");
  for (const message of messages) robot.take({ robot: "robot", ...message });
  const { type, robot: name, ...state } = robot.state ?? {};
  const { up, map, things, asking, scan, parts, joints, speech, way, doing } = robot;
  return {
    known: { up, run: plain(robot.run), rules: plain(robot.rules), state: robot.state && state, map, things, asking, scan, parts, joints, speech, way, doing },
    log: robot.entries.map(({ event }) => inWords(event)),
  };
});
const words = {};
for (language of ["en", "de"]) words[language] = events.map((event) => inWords(whole(event)));
// What the page says of the age of readings at some moments of its clock, each with what comes then, null for nothing.
let clock = 0;
performance.now = () => clock * 1000;
const watched = new Robot("robot");
const ages = steps.map(([moment, message]) => {
  clock = moment;
  if (message) watched.take({ robot: "robot", ...message });
  return [watched.age, watched.scanAge, watched.isHeard];
});
console.log(JSON.stringify({ states, words, ages }));
