// Loaded before anything is painted: the colours that were chosen, so that no page flashes in others.
try {
  const chosen = localStorage.getItem("safestart-colours");
  if (["light", "dark"].includes(chosen)) document.documentElement.dataset.colours = chosen;
} catch {
  // A browser that keeps nothing shows the system's colours.
}
