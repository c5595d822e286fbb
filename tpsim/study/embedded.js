{
  const part = document.currentScript.parentElement;
  const held = part.querySelector('script[type="application/json"]');
  const frame = part.querySelector("iframe");
  const buttons = [...part.querySelectorAll("button")];
  for (const button of buttons)
    button.addEventListener("click", () => {
      const { viewer, played } = JSON.parse(held.textContent);
      for (const other of buttons)
        other.setAttribute("aria-pressed", other === button);
      frame.hidden = false;
      frame.srcdoc = viewer[0] + played[button.dataset.clip] + viewer[1];
    });
}
