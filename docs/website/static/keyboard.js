window.addEventListener("DOMContentLoaded", () => {
  // The first stop skips the menus.
  document.body.prepend(document.querySelector(".skip-to-content") ?? "");

  // What is wider than its box can be scrolled.
  const observer = new ResizeObserver((entries) => {
    for (const { target: box } of entries) {
      if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
      else box.removeAttribute("tabindex");
    }
  });
  for (const box of document.querySelectorAll(".formula, .table-wrapper, .cell_output .output, pre")) observer.observe(box);
});
