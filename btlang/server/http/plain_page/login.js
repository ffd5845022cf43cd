const form = document.querySelector("form");
const alertText = document.querySelector("[role=alert]");

form.addEventListener("submit", async (event) => {
  event.preventDefault();
  alertText.textContent = "";
  try {
    const answer = await fetch("/api/login", {
      method: "POST",
      headers: { "content-type": "application/json" },
      body: JSON.stringify(Object.fromEntries(new FormData(form))),
    });
    if (answer.ok) location.assign("/");
    else alertText.textContent = (await answer.json()).text;
  } catch {
    alertText.textContent = "The server doesn't answer.";
  }
});
