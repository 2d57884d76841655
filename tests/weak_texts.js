// Texts that are seen with less than 4.5 : 1 between them and their ground, WCAG 2.2, 1.4.3: [ratio, text].
const luminance = (colour) => {
  const [red, green, blue] = colour.slice(0, 3).map((each) => {
    const part = each / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
};
const parsed = (text) => {
  const found = text.match(/[\d.]+/g).map(Number);
  return found.length < 4 ? [...found, 1] : found;
};
const over = (top, below) => [0, 1, 2].map((k) => top[k] * top[3] + below[k] * (1 - top[3])).concat(1);
const ground = (element) => {
  const layers = [];
  for (let each = element; each; each = each.parentElement) {
    const colour = parsed(getComputedStyle(each).backgroundColor);
    if (colour[3] > 0) layers.unshift(colour);
    if (colour[3] === 1) break;
  }
  return layers.reduce((below, top) => over(top, below), [255, 255, 255, 1]);
};
const texts = [...document.querySelectorAll('input')]
  .filter((each) => each.value && !['checkbox', 'radio', 'hidden'].includes(each.type))
  .map((each) => [each, each.value]);
const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
while (walk.nextNode()) texts.push([walk.currentNode.parentElement, walk.currentNode.textContent.trim()]);
const weak = [];
let seen = 0;
for (const [element, text] of texts) {
  const style = getComputedStyle(element);
  const hidden = !element.getClientRects().length || style.visibility === 'hidden' || element.closest('noscript');
  if (!text || hidden || element.closest('[disabled], [data-disabled]')) continue;
  seen += 1;
  const below = ground(element);
  const [low, high] = [luminance(over(parsed(style.color), below)), luminance(below)].sort((a, b) => a - b);
  const ratio = (high + 0.05) / (low + 0.05);
  if (ratio < 4.5) weak.push([Math.round(100 * ratio) / 100, text.slice(0, 40)]);
}
return { seen, weak };
