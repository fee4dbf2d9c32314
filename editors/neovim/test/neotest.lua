-- Tests of the adapter for neotest: `nvim --headless --clean -l test/neotest.lua` in the plugin's folder, with
--
--     $HYPEDC    the hypedc executable
--     $PLUGINS   a folder with neotest, nvim-nio and plenary.nvim; without it, a stand-in takes their place

local harness = dofile('test/harness.lua')
local test, same, wait_for = harness.test, harness.same, harness.wait_for

local plugins = os.getenv('PLUGINS')
if plugins then
  for _, name in ipairs({ 'neotest', 'nvim-nio', 'plenary.nvim' }) do
    vim.opt.runtimepath:append(vim.fs.joinpath(plugins, name))
  end
else
  dofile('test/stand_in.lua')
end
local nio = require('nio')

local folder = vim.fn.resolve(vim.fn.tempname())
vim.fn.mkdir(folder .. '/.git', 'p')
vim.env.XDG_CACHE_HOME = folder .. '/cache'
local file = folder .. '/walk.hyped'
local text = {
  'entity Walker {',
  '    button right',
  '    mode still {',
  "        x' = 0",
  '        when held(right) -> going',
  '    }',
  '    mode going {',
  "        x' = 60",
  '        when not held(right) -> still',
  '    }',
  '}',
  'world Road {',
  '    step 1/60',
  '    space main {',
  '        bounds rect(0, 0, 320, 32)',
  '        place hero: Walker at (0, 0)',
  '    }',
  '    player 1: hero',
  '    goal there: hero.x > 20',
  '    never beyond: hero.x > 300',
  '    test "it goes" {',
  '        inputs "right*60"',
  '        expect hero.x > 20 at end',
  '    }',
  '    test "too far" {',
  '        inputs "right*10"',
  '        expect hero.x > 200 at end',
  '    }',
  '}',
}
vim.fn.writefile(text, file)
vim.fn.writefile({ 'entity Nothing { mode a { } }' }, folder .. '/nothing.hyped')
vim.cmd.cd(folder)

local adapter = require('neotest-hyped')

--- What an asynchronous function returns.
local function waited(body)
  local done, result = false, nil
  nio.run(body, function(ok, value)
    assert(ok, value)
    done, result = true, value
  end)
  wait_for('the end of a task', function() return done end)
  return result
end

local function discovered(path)
  return waited(function() return adapter.discover_positions(path) end)
end

--- Runs a part of a tree as neotest does: the specification, its strategy, the results.
local function run(tree)
  return waited(function()
    local spec = adapter.build_spec({ tree = tree, strategy = 'integrated' })
    local process = spec.strategy(spec, {})
    local code = process.result()
    return { code = code, results = adapter.results(spec, { code = code, output = process.output() }, tree) }
  end)
end

test('programs are files with tests', function()
  same(adapter.root(folder), folder)
  same({ adapter.is_test_file(file), adapter.is_test_file(folder .. '/level.txt') }, { true, false })
  same({ adapter.filter_dir('.git'), adapter.filter_dir('levels') }, { false, true })
  same(discovered(folder .. '/nothing.hyped'), nil)
end)

test('worlds, tests, goals and nevers are listed without an open buffer', function()
  local found = {}
  for _, of in discovered(file):iter() do
    found[#found + 1] = ('%s %s %d'):format(of.type, of.name, of.range[1])
  end
  same(found, {
    'file walk.hyped 0',
    'namespace Road 11',
    'test goal there 18',
    'test never beyond 19',
    'test it goes 20',
    'test too far 24',
  })
end)

test('all of a file runs, and failures are at their lines', function()
  local ran = run(discovered(file))
  local status, lines = {}, {}
  for id, of in pairs(ran.results) do
    local name = id:gsub('^.*::', '')
    status[name] = of.status
    lines[name] = of.errors and of.errors[1] and of.errors[1].line
  end
  same(status, { ['goal there'] = 'passed', ['never beyond'] = 'failed', ['test it goes'] = 'passed', ['test too far'] = 'failed' })
  same(lines, { ['never beyond'] = 19, ['test too far'] = 26 })
  same(ran.code, 1)
  local failed = ran.results[file .. '::Road::test too far']
  assert(failed.errors[1].message:find('and 200', 1, true), failed.errors[1].message)
  local output = table.concat(vim.fn.readfile(failed.output), '\n')
  assert(output:find('passed  Road: it goes', 1, true) and output:find('failed  Road: too far', 1, true), output)
end)

test('one test runs on the buffer, not on the file', function()
  vim.cmd.edit(file)
  wait_for('a client', function() return #vim.lsp.get_clients({ bufnr = 0, name = 'hypedc' }) == 1 end)
  vim.cmd('silent %s/> 200/> 5')
  local ran = run(discovered(file):get_key(file .. '::Road::test too far'))
  same(vim.tbl_values(vim.tbl_map(function(of) return of.status end, ran.results)), { 'passed' })
  vim.cmd('silent undo')
end)

if plugins then
  test('neotest runs a file, and shows its failures', function()
    local neotest = require('neotest')
    neotest.setup({ adapters = { adapter }, log_level = vim.log.levels.ERROR })
    vim.cmd.edit(file)
    waited(function() neotest.run.run(file) end)
    local id = 'neotest-hyped:' .. folder
    wait_for('all results', function()
      local counts = neotest.state.status_counts(id)
      return counts and counts.running == 0 and counts.passed + counts.failed == 4
    end)
    local counts = neotest.state.status_counts(id)
    same({ counts.total, counts.passed, counts.failed }, { 4, 2, 2 })
    local namespace = vim.api.nvim_get_namespaces()['neotest']
    wait_for('diagnostics', function() return #vim.diagnostic.get(0, { namespace = namespace }) == 2 end)
    local lines = vim.tbl_map(function(of) return of.lnum end, vim.diagnostic.get(0, { namespace = namespace }))
    table.sort(lines)
    same(lines, { 19, 26 })
  end)
end

for _, client in ipairs(vim.lsp.get_clients()) do
  client:stop()
end
wait_for('the end of the server', function() return #vim.lsp.get_clients() == 0 end)
harness.finish()
