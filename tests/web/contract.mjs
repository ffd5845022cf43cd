// The reducer of the page, its words for events and what else needs no browser: prints what it makes of the cases in a file.
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [folder, file] = process.argv.slice(2);
const { lists, events, steps, languages, documents, rules, schedules, film, spoken } = JSON.parse(readFileSync(file, "utf8"));
let language = "en";
globalThis.localStorage = { getItem: () => language };
const page = await import(pathToFileURL(`${folder}/page.js`));
const { Robot, inWords, loadTexts, patched, ruleInWords, ruleStates, seriesOf, valueAt, whole } = page;
await loadTexts();

const plain = (run) => run && { id: run.id, task: run.task, statuses: run.statuses, words: run.nodes.map(([, , words]) => words) };
const states = lists.map((messages) => {
  const robot = new Robot("robot");
  for (const message of messages) robot.take({ robot: "robot", ...message });
  const { type, robot: name, ...state } = robot.state ?? {};
  const { up, map, things, asking, scan, parts, joints, speech, values, way, doing } = robot;
  return {
    known: { up, run: plain(robot.run), rules: plain(robot.rules), state: robot.state && state, map, things, asking, scan, parts, joints, speech, values, way, doing },
    log: robot.entries.map(({ event }) => inWords(event)),
  };
});
const [words, due, said] = [{}, {}, {}];
for (language of languages) {
  await loadTexts();
  said[language] = spoken.map((each) => page.said(each)); // another function in each language
  due[language] = schedules.map(ruleInWords);
  words[language] = events.map((event) => inWords(whole(event)));
}
language = "en";
await loadTexts();
// What the page says of the age of readings at some moments of its clock, each with what comes then, null for nothing.
let clock = 0;
performance.now = () => clock * 1000;
const watched = new Robot("robot");
const ages = steps.map(([moment, message]) => {
  clock = moment;
  if (message) watched.take({ robot: "robot", ...message });
  return [watched.age, watched.scanAge, watched.isHeard];
});
// A document of which only differences come, the states of house rules, and values over time.
let nodes = [];
const shown = documents.map(({ difference, change }) => (nodes = change ? patched(nodes, difference, change) : difference));
const series = seriesOf(film);
console.log(JSON.stringify({ states, words, due, said, ages, shown, rules: ruleStates(...rules), series, values: series.map((each) => [1, 2.5, 9].map((moment) => valueAt(each, moment))) }));
