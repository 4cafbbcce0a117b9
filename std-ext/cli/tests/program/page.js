// Uses the page as a reader would: every switch, every method, pointer and keys, every table and
// picture. What is wrong goes to a list, which the test reads from the document.
(async function () {
  var all = function (selector, root) { return Array.from((root || document).querySelectorAll(selector)); };
  var found = { switches: 0, methods: 0, charts: 0, tables: 0, pictures: 0, wrong: window.wrong };
  var check = function (holds, what) { if (!holds) found.wrong.push(what); };
  var visible = function (element) {
    var box = element.getBoundingClientRect();
    return box.width > 0 && box.height > 0;
  };
  try {
    // Every combination of the switches shows its own parts, with figures drawn in them.
    var inputs = all('.choose input');
    found.switches = inputs.length;
    var names = Array.from(new Set(inputs.map(function (input) { return input.name; })));
    var seen = new Set();
    var states = names.reduce(function (states, name) {
      var options = inputs.filter(function (input) { return input.name === name; });
      return states.flatMap(function (state) { return options.map(function (option) { return state.concat(option); }); });
    }, [[]]);
    states.forEach(function (state) {
      state.forEach(function (input) { input.click(); });
      var values = state.map(function (input) { return input.name + '=' + input.value; });
      all('[data-when]').forEach(function (part) {
        var wanted = part.dataset.when.split(' ').every(function (rule) { return values.includes(rule); });
        check(part.hidden === !wanted, values + ': ' + part.dataset.when + ' hidden: ' + part.hidden);
      });
      all('.chart').filter(visible).forEach(function (chart) {
        seen.add(chart.id);
        check(all('.c .l', chart).some(function (line) { return line.getTotalLength() > 20; }), chart.id + ': no curve');
        check(all('.c .m', chart).length >= 2 && all('.c .m', chart).every(visible), chart.id + ': no marks');
        check(all('.tick', chart).length >= 4, chart.id + ': no ticks');
        check(!/NaN|Infinity|undefined/.test(chart.outerHTML), chart.id + ': no numbers');
      });
      check(all('#accuracy .chart').filter(visible).length === 4, values + ': not four figures');
    });
    found.charts = seen.size;
    check(all('.chart').length === seen.size, 'figures that no switch shows');

    // A method that is switched off has no curves, and comes back.
    var chart = all('.chart').find(visible);
    all('[data-method]').forEach(function (input) {
      found.methods += 1;
      var curves = all('[data-m="' + input.dataset.method + '"]', chart);
      input.click();
      check(curves.every(function (curve) { return !visible(curve); }), input.dataset.method + ' is not hidden');
      input.click();
      check(curves.every(visible), input.dataset.method + ' does not come back');
    });

    // Pointer and keys make points say their numbers.
    var tip = document.getElementById('tip');
    var mark = chart.querySelector('.c .m');
    mark.scrollIntoView({ block: 'center', behavior: 'instant' });
    await new Promise(function (done) { setTimeout(done, 200); });
    var box = mark.getBoundingClientRect();
    chart.dispatchEvent(new PointerEvent('pointermove', { clientX: box.left + box.width / 2, clientY: box.top + box.height / 2, bubbles: true }));
    check(!tip.hidden && /N = .*%/.test(tip.textContent), 'the pointer meets no point: ' + tip.textContent);
    chart.focus();
    var before = tip.textContent;
    chart.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', bubbles: true, cancelable: true }));
    check(!tip.hidden && tip.textContent !== before, 'an arrow key goes nowhere');
    chart.dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape', bubbles: true }));
    check(tip.hidden, 'the numbers do not go away');

    // Tables are complete: as many cells in each row as in the head, none empty, and a file each.
    all('details').forEach(function (part) { part.open = true; });
    all('table[id]').forEach(function (table) {
      found.tables += 1;
      var width = all('thead th', table).length;
      check(width >= 2 && all('tbody tr', table).length >= 1, table.id + ': empty');
      all('tbody tr', table).forEach(function (row) {
        check(row.children.length === width, table.id + ': a row of ' + row.children.length + ', not ' + width);
      });
      check(!/NaN|undefined|inf\b/.test(table.textContent), table.id + ': no numbers');
      check(document.querySelector('a[download="' + table.id + '.csv"]'), table.id + ': no file');
    });
    all('a[download]').forEach(function (link) {
      var file = atob(link.href.slice(link.href.indexOf(',') + 1));
      check(file.split('\n').length >= 3 && file.includes(','), link.download + ': empty');
    });
    for (var picture of all('img')) {
      picture.loading = 'eager';
      if (!picture.complete) {
        await new Promise(function (done) { picture.onload = picture.onerror = done; });
      }
      check(picture.naturalWidth > 0, picture.alt + ': no picture');
      found.pictures += 1;
    }
    check(all('[id]').length === new Set(all('[id]').map(function (part) { return part.id; })).size, 'a name that is there twice');
    check(document.documentElement.scrollWidth <= innerWidth, 'wider than the window: ' + document.documentElement.scrollWidth + ' > ' + innerWidth);
    check(document.querySelector('h1') && all('h2').length >= 6, 'headings are missing');
  } catch (error) {
    found.wrong.push('the test failed: ' + error);
  }
  var result = document.createElement('pre');
  result.id = 'found';
  result.textContent = JSON.stringify(found);
  document.body.append(result);
})();
