-- An adapter for neotest: the worlds of programs with their tests, goals and `never`s, as the language server lists them. It
-- runs them, too, on the texts of the buffers, saved or not.
--
--     require('neotest').setup({ adapters = { require('neotest-hyped') } })

local nio = require('nio')
local Tree = require('neotest.types').Tree

local answers = require('hyped.answers')

--- The server answers no request before this time after its start, ms.
local START = 10000

local Adapter = { name = 'neotest-hyped' }

--- A client of the language server that knows a file; starts one if there is none.
---@async
local function client_of(path)
  nio.scheduler()
  local client = require('hyped.level').client(path) or vim.lsp.get_clients({ name = 'hypedc' })[1]
  if not client then
    local config = vim.tbl_extend('force', vim.lsp.config.hypedc, { name = 'hypedc', root_dir = Adapter.root(vim.fs.dirname(path)) })
    local id = vim.lsp.start(config, { attach = false })
    client = id and vim.lsp.get_client_by_id(id)
  end
  local waited = 0
  while client and not client.initialized and waited < START do
    nio.sleep(20)
    waited = waited + 20
  end
  return client and client.initialized and client or nil
end

--- A request to the server: its result, or nil and why not. `began` is told how to cancel it.
---@async
local function request(client, method, parameters, began)
  local answer = nio.control.future()
  nio.scheduler()
  local sent, id = client:request(method, parameters, function(failure, result)
    if not answer.is_set() then
      answer.set({ result = result, failure = failure })
    end
  end)
  if not sent then
    return nil, 'the language server does not run'
  end
  if began then
    began(function() client:cancel_request(id) end)
  end
  local came = answer.wait()
  if came.failure then
    return nil, came.failure.message
  end
  return came.result
end

function Adapter.root(dir)
  return vim.fs.root(dir, '.git') or (vim.fn.glob(dir .. '/*.hyped') ~= '' and dir or nil)
end

function Adapter.filter_dir(name)
  return not vim.startswith(name, '.') and name ~= 'node_modules' and name ~= 'target'
end

function Adapter.is_test_file(path)
  return vim.endswith(path, '.hyped')
end

local function position(kind, id, name, path, range, more)
  return vim.tbl_extend('error', {
    type = kind,
    id = id,
    name = name,
    path = path,
    range = { range.start.line, range.start.character, range['end'].line, range['end'].character },
  }, more or {})
end

---@async
function Adapter.discover_positions(path)
  local client = client_of(path)
  local found = client and request(client, 'hypedc/tests', { textDocument = { uri = vim.uri_from_fname(path) } })
  local worlds = found and found[1] and found[1].worlds or {}
  if #worlds == 0 then
    return nil
  end
  local last = { line = 0, character = 0 }
  local file = {}
  for _, world in ipairs(worlds) do
    local id = path .. '::' .. world.name
    local inner = { position('namespace', id, world.name, path, world.range) }
    for _, kind in ipairs({ 'test', 'goal', 'never' }) do
      for _, of in ipairs(world[kind .. 's']) do
        local name = kind == 'test' and of.name or ('%s %s'):format(kind, of.name)
        local about = { kind = kind, world = world.name, of = of.name }
        inner[#inner + 1] = { position('test', ('%s::%s %s'):format(id, kind, of.name), name, path, of.range, { hyped = about }) }
      end
    end
    -- A tree is in the order of the text.
    table.sort(inner, function(a, b)
      local x, y = a[1] or a, b[1] or b
      if x.type ~= y.type then
        return x.type == 'namespace'
      end
      return x.range[1] < y.range[1] or (x.range[1] == y.range[1] and x.range[2] < y.range[2])
    end)
    file[#file + 1] = inner
    if world.range['end'].line >= last.line then
      last = world.range['end']
    end
  end
  table.insert(file, 1, position('file', path, vim.fs.basename(path), path, { start = { line = 0, character = 0 }, ['end'] = last }))
  return Tree.from_list(file, function(of) return of.id end)
end

--- The result of a position, and the lines that tell it.
---@async
local function run(of, began)
  local about = of.hyped
  local client = client_of(of.path)
  if not client then
    return { status = 'failed', errors = { { message = 'the language server does not run', line = of.range[1] } } }
  end
  local arguments = { uri = vim.uri_from_fname(of.path), world = about.world }
  arguments[about.kind .. 's'] = { about.of }
  local command = about.kind == 'test' and 'hypedc.test' or 'hypedc.reach'
  local found, why = request(client, 'workspace/executeCommand', { command = command, arguments = { arguments } }, began)
  if not found then
    return { status = 'failed', short = why, errors = { { message = why, line = of.range[1] } } }
  end
  if about.kind == 'test' then
    local test = found.tests[1]
    if not test then
      return { status = 'skipped', short = 'the program has no such test any more' }
    end
    local errors = answers.failures(test)
    local lines = vim.tbl_map(function(failure) return failure.message end, errors)
    return { status = test.passed and 'passed' or 'failed', short = table.concat(lines, '\n'), errors = errors }
  end
  local answer = found.goals[1]
  local short = table.concat(answers.lines_of(answer), '\n')
  local errors = not answer.is_expected and { { message = short, line = of.range[1] } } or nil
  return { status = answer.is_expected and 'passed' or 'failed', short = short, errors = errors }
end

--- Runs the positions of a specification one after the other: the process of neotest is a server that runs already.
---@async
local function strategy(spec)
  local output = nio.fn.tempname()
  local done, results = nio.control.future(), spec.context.results
  local stream = nio.control.queue()
  local is_stopped, stop = false, nil
  nio.run(function()
    local told = {}
    for _, of in ipairs(spec.context.positions) do
      local ok, result = pcall(run, of, function(cancel) stop = cancel end)
      if not ok then
        result = { status = 'failed', short = tostring(result), errors = { { message = tostring(result), line = of.range[1] } } }
      end
      if is_stopped then
        result = { status = 'skipped' }
      end
      results[of.id] = result
      local line = ('%s  %s: %s'):format(result.status, of.hyped.world, of.name)
      told[#told + 1] = line
      if result.short and result.short ~= '' then
        told[#told + 1] = '    ' .. result.short:gsub('\n', '\n    ')
      end
      stream.put_nowait(line .. '\n')
    end
    local file = assert(io.open(output, 'w'))
    file:write(table.concat(told, '\n') .. '\n')
    file:close()
    done.set()
  end)
  return {
    is_complete = function() return done.is_set() end,
    output = function() return output end,
    output_stream = function()
      return function() return nio.first({ stream.get, done.wait }) end
    end,
    attach = function() end,
    stop = function()
      is_stopped = true
      if stop then
        stop()
      end
    end,
    result = function()
      done.wait()
      for _, result in pairs(results) do
        if result.status == 'failed' then
          return 1
        end
      end
      return 0
    end,
  }
end

function Adapter.build_spec(args)
  local positions = {}
  for _, of in args.tree:iter() do
    if of.type == 'test' then
      positions[#positions + 1] = of
    end
  end
  if #positions == 0 then
    return nil
  end
  return {
    command = { 'hypedc', 'lsp' },
    strategy = strategy,
    context = { positions = positions, results = {} },
  }
end

---@async
function Adapter.results(spec, result)
  for _, of in pairs(spec.context.results) do
    of.output = result.output
  end
  return spec.context.results
end

return Adapter
