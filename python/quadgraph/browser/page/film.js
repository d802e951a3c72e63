// Films on the page: what they are to show, how far they are, and the file once there is one.
"use strict";

let awaits = false;  // the film that is being made was begun here, and is to be kept as a file

function filmText(film) {
  const done = `film: ${film.done} of ${film.frames} frames`;
  if (film.seconds_left === null) return done;
  const seconds = Math.round(film.seconds_left), minutes = Math.floor(seconds / 60);
  return `${done}, ${minutes ? `${minutes} min ` : ""}${seconds % 60} s left`;
}

function hearFilm(film) {
  const making = film.is === "making", ready = film.is === "ready";
  document.body.dataset.film = film.is;
  $("filming").hidden = !making;
  $("save-film").disabled = making;
  $("film").hidden = !ready;
  if (making) {
    $("film-text").textContent = filmText(film);
    $("film-bar").value = film.done / film.frames;
  }
  if (ready) {
    $("film").download = `film${film.suffix}`;
    $("film").href = `film?token=${encodeURIComponent(token)}`;
    if (awaits) $("film").click();
  }
  if (film.is === "failed") trouble(`no film: ${film.why}`);
  if (!making) awaits = false;
}

// What a film can show.
function greetFilm(hello) {
  for (const option of $("film-turn").options) option.hidden = !hello.films.includes(option.value);
}

function listenFilm() {
  // Frames of the file take as long as it says.
  $("film-turn").addEventListener("change", () => ($("film-seconds").disabled = $("film-turn").value === "frames"));
  $("save-film").addEventListener("click", () => {
    awaits = true;
    trouble("");
    const [turn, seconds, suffix] = ["turn", "seconds", "suffix"].map((name) => $(`film-${name}`).value);
    send({ film: { turn, seconds: Number(seconds), suffix } });
  });
  $("filming").addEventListener("pointerdown", (event) => event.stopPropagation());  // it is no drag of the picture
  $("cancel-film").addEventListener("click", () => send({ film: "cancel" }));
}
