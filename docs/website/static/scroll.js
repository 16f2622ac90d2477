// What is wider than its box can be scrolled by the keyboard.
const BOXES = ".formula, .table-wrapper, pre";
const makeReachable = () => {
  for (const box of document.querySelectorAll(BOXES)) {
    if (box.scrollWidth > box.clientWidth) {
      box.tabIndex = 0;
    } else {
      box.removeAttribute("tabindex");
    }
  }
};
window.addEventListener("load", makeReachable);
window.addEventListener("resize", makeReachable);
