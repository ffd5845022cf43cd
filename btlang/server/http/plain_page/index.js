// What all who are logged in need: which robots there are, what they do, and the emergency stop.
const CONFIRMED = 1000; // milliseconds in which a robot has to say that it was stopped
const OVER = ["completed", "failed", "canceled", "killed", "error", "skipped"];
const alertText = document.querySelector("[role=alert]");
const robots = new Map();
let csrf = "";

const send = (path, data, signal) =>
  fetch(path, {
    method: "POST",
    headers: { "content-type": "application/json", "x-csrf-token": csrf },
    body: JSON.stringify(data),
    signal,
  });

async function stop(robot) {
  try {
    const answer = await send("/api/stop", { robot }, AbortSignal.timeout(CONFIRMED));
    const { text } = await answer.json();
    alertText.textContent = answer.ok ? `${robot} is stopped.` : text;
  } catch {
    alertText.textContent = `${robot} HAS NOT CONFIRMED THE STOP: stop it where it stands.`;
  }
}

async function release(robot) {
  const answer = await send("/api/commands", { command: "release", robot });
  alertText.textContent = answer.ok ? "" : (await answer.json()).text;
}

function shown(name) {
  if (!robots.has(name)) {
    const section = document.querySelector("template").content.firstElementChild.cloneNode(true);
    section.querySelector("h2").textContent = name;
    section.querySelector(".stop").addEventListener("click", () => stop(name));
    section.querySelector(".release").addEventListener("click", () => release(name));
    const list = document.querySelector("#robots");
    if (robots.size === 0) list.replaceChildren();
    list.append(section);
    robots.set(name, { section, tasks: new Map() });
  }
  return robots.get(name);
}

function take(message, socket) {
  if (message.type === "result" && message.id && message.ok) taken(message.id, message.data.tasks);
  if (message.robot === undefined) return;
  const { section, tasks } = shown(message.robot);
  const state = section.querySelector(".state");
  if (message.type === "up") {
    state.textContent = "up";
    socket.send(JSON.stringify({ id: message.robot, command: "list", robot: message.robot }));
  }
  if (message.type === "away") state.textContent = "away";
  if (message.type === "robot") {
    const battery = message.battery === null ? "" : `, battery ${Math.round(message.battery)}%`;
    state.textContent = (message.hindrance || "ready") + battery;
    section.querySelector(".release").hidden = !message.stopped;
  }
  if (message.type === "change") {
    if (OVER.includes(message.state)) tasks.delete(message.task);
    else tasks.set(message.task, message.state);
    list(section, tasks);
  }
}

function list(section, tasks) {
  const line = ([task, state]) => Object.assign(document.createElement("li"), { textContent: `Task ${task}: ${state}` });
  section.querySelector(".tasks").replaceChildren(...[...tasks].map(line));
}

function taken(name, listed) {
  const { section, tasks } = shown(name);
  tasks.clear();
  for (const task of listed) tasks.set(task.id, task.state);
  list(section, tasks);
}

function follow() {
  const socket = new WebSocket(`${location.origin.replace("http", "ws")}/api/ws`);
  socket.addEventListener("open", () => socket.send(JSON.stringify({ type: "subscribe", topics: ["robot", "tasks"], rate: 2 })));
  socket.addEventListener("message", (event) => take(JSON.parse(event.data), socket));
  socket.addEventListener("close", (event) => {
    if (event.code === 4001) return location.assign("/login");
    for (const { section } of robots.values()) section.querySelector(".state").textContent = "no connection";
    setTimeout(follow, 1000);
  });
}

document.querySelector("#leave").addEventListener("click", async () => {
  await send("/api/logout", {});
  location.assign("/login");
});

const me = await fetch("/api/me");
if (!me.ok) location.assign("/login");
else {
  const { user, role, csrf: token } = await me.json();
  csrf = token;
  document.querySelector("#who").textContent = `${user} (${role})`;
  follow();
}
