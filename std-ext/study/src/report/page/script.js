'use strict';
(function () {
  var all = function (selector, root) { return Array.from((root || document).querySelectorAll(selector)); };

  // Switches: what names a state is shown in that state only.
  var form = document.querySelector('.choose');
  function choose() {
    var state = {};
    all('input:checked', form).forEach(function (input) { state[input.name] = input.value; });
    all('[data-when]').forEach(function (part) {
      part.hidden = !part.dataset.when.split(' ').every(function (rule) {
        var at = rule.indexOf('=');
        return state[rule.slice(0, at)] === rule.slice(at + 1);
      });
    });
    point(null);
  }

  // Methods, shown and hidden in every figure.
  function toggle(input) {
    all('.chart [data-m="' + input.dataset.method + '"]').forEach(function (curve) {
      curve.style.display = input.checked ? '' : 'none';
    });
    point(null);
  }

  // The point that is nearest to the pointer, or chosen by arrow keys, says its numbers.
  var tip = document.getElementById('tip');
  var current = null;
  function point(mark) {
    if (current) current.classList.remove('on');
    current = mark;
    tip.hidden = !mark;
    if (!mark) return;
    mark.classList.add('on');
    tip.textContent = mark.dataset.says;
    var box = mark.getBoundingClientRect();
    var left = box.left + box.width / 2 + 12;
    if (left + tip.offsetWidth > innerWidth - 8) left = Math.max(8, box.left - tip.offsetWidth - 12);
    var top = box.top - tip.offsetHeight - 8;
    tip.style.transform = 'translate(' + left + 'px,' + (top < 8 ? box.bottom + 8 : top) + 'px)';
  }
  function marks(chart) {
    return all('.c', chart).filter(function (curve) { return curve.style.display !== 'none'; })
      .flatMap(function (curve) { return all('.m', curve); });
  }
  function nearest(chart, x, y) {
    var best = null, least = 40 * 40;
    marks(chart).forEach(function (mark) {
      var box = mark.getBoundingClientRect();
      var dx = box.left + box.width / 2 - x, dy = box.top + box.height / 2 - y;
      if (dx * dx + dy * dy < least) { least = dx * dx + dy * dy; best = mark; }
    });
    return best;
  }

  all('.chart .m').forEach(function (mark) {
    var title = mark.querySelector('title');
    if (title) { mark.dataset.says = title.textContent; title.remove(); }
  });
  all('.chart').forEach(function (chart) {
    chart.addEventListener('pointermove', function (event) { point(nearest(chart, event.clientX, event.clientY)); });
    chart.addEventListener('pointerdown', function (event) { point(nearest(chart, event.clientX, event.clientY)); });
    chart.addEventListener('pointerleave', function (event) { if (event.pointerType === 'mouse') point(null); });
    chart.addEventListener('blur', function () { point(null); });
    chart.addEventListener('keydown', function (event) {
      var step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
      if (event.key === 'Escape') point(null);
      if (!step) return;
      event.preventDefault();
      var own = marks(chart), at = own.indexOf(current);
      point(own[at < 0 ? 0 : (at + step + own.length) % own.length]);
    });
  });
  addEventListener('scroll', function () { point(null); }, { passive: true });
  if (form) form.addEventListener('change', choose);
  all('[data-method]').forEach(function (input) {
    input.addEventListener('change', function () { toggle(input); });
  });
  choose();
  // Forms may come back as they were left.
  all('[data-method]').forEach(toggle);
})();
