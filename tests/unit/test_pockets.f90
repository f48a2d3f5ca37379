!> Parts of the gas that walls keep from each other: they are found on any number of ranks, closed where others have an outflow, and
!> have a pressure of their own where none has.
! ranks: 1 2
program test_pockets
  use boxes, only: boxes_t, new_boxes
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, make_gas
  use kinds, only: wp
  use mesh_scenes, only: drum, tube, mesh_wall => mesh
  use open_parts, only: open_parts_t, find_parts
  use open_space, only: open_space_t
  use outcome, only: outcome_t
  use surface, only: new_surface
  implicit none

  real(wp), parameter :: o = 0.0_wp, edge = 0.1_wp, middle = 0.5_wp*edge
  integer, parameter :: segments = 24
  type(communicator_t) :: comm

  call start_ranks(comm)
  call mazes()
  call pocket()
  call two_chambers()
  call fed_pocket()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> Random cells and faces, with and without joined faces, against a search over the whole grid.
  subroutine mazes()
    integer, parameter :: cells(3) = [9, 12, 8]
    type(boxes_t) :: boxes
    type(open_space_t) :: space
    type(open_parts_t) :: parts
    type(outcome_t) :: outcome
    logical :: periodic(3), same
    integer, allocatable :: whole(:,:,:)
    integer :: seed, p

    do seed = 1, 6
      periodic = [modulo(seed, 2) == 0, .false., modulo(seed, 3) == 0]
      call new_boxes(comm, cells, periodic, boxes, outcome)
      call make_maze(boxes, seed, space)
      call find_parts(boxes, space, parts)
      whole = searched(cells, periodic, seed)
      associate (n => boxes%n, lo => boxes%lo, hi => boxes%hi)
        same = all(parts%part(1:n(1), 1:n(2), 1:n(3)) == whole(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)))
      end associate
      same = .not. comm%any_of(.not. same)
      do p = 1, parts%n
        same = same .and. whole(parts%first(1, p), parts%first(2, p), parts%first(3, p)) == p
      end do
      if (comm%is_root()) call expect(same .and. parts%n == maxval(whole) .and. parts%n > 3, 'parts of a maze')
    end do
  end subroutine mazes

  !> Whether a cell (a = 0) of a maze or its upper face across a is open.
  pure recursive function is_open(cells, periodic, seed, cell, a) result(open)
    integer, intent(in) :: cells(3), seed, cell(3), a
    logical, intent(in) :: periodic(3)
    logical :: open

    integer :: next(3)

    open = modulo(sin(12.9898_wp*cell(1) + 78.233_wp*cell(2) + 37.719_wp*cell(3) + 1.7_wp*seed + 5.3_wp*a)*43758.5453_wp, 1.0_wp) &
      > merge(0.3_wp, 0.4_wp, a == 0)
    if (a == 0 .or. .not. open) return
    next = cell
    next(a) = next(a) + 1
    if (periodic(a)) next(a) = 1 + modulo(next(a) - 1, cells(a))
    open = next(a) <= cells(a)
    if (open) open = is_open(cells, periodic, seed, cell, 0) .and. is_open(cells, periodic, seed, next, 0)
  end function is_open

  subroutine make_maze(boxes, seed, space)
    type(boxes_t), intent(in) :: boxes
    integer, intent(in) :: seed
    type(open_space_t), intent(out) :: space

    integer :: i, j, k, a, cell(3)

    associate (n => boxes%n)
      allocate (space%volume(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2), source=1.0_wp)
      allocate (space%area(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2, 3), source=0.0_wp)
      allocate (space%closed(n(1), n(2), n(3)), source=.false.)
      do k = 0, n(3)
        do j = 0, n(2)
          do i = 0, n(1)
            cell = boxes%lo + [i, j, k] - 1
            if (all([i, j, k] > 0)) space%closed(i, j, k) = .not. is_open(boxes%cells, boxes%periodic, seed, cell, 0)
            cell = merge(1 + modulo(cell - 1, boxes%cells), cell, boxes%periodic)
            if (any(cell < 1)) cycle
            do a = 1, 3
              if (is_open(boxes%cells, boxes%periodic, seed, cell, a)) space%area(i, j, k, a) = 1.0_wp
            end do
          end do
        end do
      end do
    end associate
  end subroutine make_maze

  !> The parts of a maze, numbered in the order of their first cells.
  pure function searched(cells, periodic, seed) result(part)
    integer, intent(in) :: cells(3), seed
    logical, intent(in) :: periodic(3)
    integer :: part(cells(1), cells(2), cells(3))

    integer :: i, j, k, n
    logical :: again

    part = 0
    n = 0
    do k = 1, cells(3)
      do j = 1, cells(2)
        do i = 1, cells(1)
          if (part(i, j, k) > 0 .or. .not. is_open(cells, periodic, seed, [i, j, k], 0)) cycle
          n = n + 1
          part(i, j, k) = n
          again = .true.
          do while (again)
            call grow(cells, periodic, seed, part, again)
          end do
        end do
      end do
    end do
  end function searched

  !> Number the neighbours of numbered cells; whether there are any.
  pure subroutine grow(cells, periodic, seed, part, again)
    integer, intent(in) :: cells(3), seed
    logical, intent(in) :: periodic(3)
    integer, intent(inout) :: part(:,:,:)
    logical, intent(out) :: again

    integer :: i, j, k, a, next(3), number

    again = .false.
    do k = 1, cells(3)
      do j = 1, cells(2)
        do i = 1, cells(1)
          do a = 1, 3
            if (.not. is_open(cells, periodic, seed, [i, j, k], a)) cycle
            next = [i, j, k]
            next(a) = 1 + modulo(next(a), cells(a))
            number = max(part(i, j, k), part(next(1), next(2), next(3)))
            again = again .or. part(i, j, k) /= part(next(1), next(2), next(3))
            part(i, j, k) = number
            part(next(1), next(2), next(3)) = number
          end do
        end do
      end do
    end do
  end subroutine grow

  !> A hollow drum in a cube, the gas on both sides of its shell.
  function hollow() result(scene)
    type(scene_t) :: scene

    scene = scene_t(cells=[20, 20, 20], upper=[edge, edge, edge])
    scene%walls = [mesh_wall()]
    scene%walls%gas_side = 'outside'
    scene%surfaces = [new_surface(reshape([drum([middle, 0.02_wp, middle], [o, 0.06_wp, o], 0.035_wp, segments, 0, o), &
                                           drum([middle, 0.03_wp, middle], [o, 0.04_wp, o], 0.022_wp, segments, 0, o)], &
                                          [3, 3, 8*segments]))]
    scene%numerics%tolerance = 1.0e-9_wp
    allocate (scene%records(0))
  end function hollow

  !> Area of the polygon of a drum [m2].
  pure function section(radius)
    real(wp), intent(in) :: radius  !< [m]
    real(wp) :: section

    section = 0.5_wp*segments*sin(2*pi/segments)*radius**2
  end function section

  !> Where others have an outflow a pocket is closed, and flow goes round it.
  subroutine pocket()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    logical :: converged
    real(wp) :: within

    scene = hollow()
    scene%records = [record('in', 'inflow', [o, o, o], [edge, o, edge], velocity=0.1_wp), &
                     record('out', 'outflow', [o, edge, o], scene%upper)]
    call make_gas(comm, scene, gas, outcome)
    call gas%advance(1.0e-2_wp, converged)
    within = o
    if (.not. outcome%failed()) within = sum_within(gas)
    if (comm%is_root()) then
      call expect(converged, 'a pocket does not keep the gas from converging')
      call expect(gas%space%pockets == 1 .and. gas%levels%n == 0, 'there is one')
      call expect_close(gas%space%pocket_volume, section(0.022_wp)*0.04_wp, 2.0e-2_wp, 'as large as it is [m3]')
      call expect_close(gas%space%open_volume, edge**3 - section(0.035_wp)*0.06_wp, 5.0e-3_wp, 'and no part of the rest [m3]')
      call expect(all(gas%space%pocket_place > 0.027_wp) .and. all(gas%space%pocket_place < 0.073_wp), 'there it is')
      call expect_close(within, o, 0.0_wp, 'nothing moves there')
    end if
    call gas%destroy()
  end subroutine pocket

  !> Speeds of the faces around the middle, over all ranks [m/s].
  function sum_within(gas) result(total)
    type(gas_t), intent(in) :: gas
    real(wp) :: total

    real(wp) :: x(3)
    integer :: i, j, k

    total = o
    do k = 1, gas%boxes%n(3)
      do j = 1, gas%boxes%n(2)
        do i = 1, gas%boxes%n(1)
          x = (gas%boxes%lo + [i, j, k] - 1.5_wp)*0.005_wp - middle
          if (maxval(abs(x)) < 0.01_wp) total = total + sum(abs(gas%velocity(i, j, k, :)))
        end do
      end do
    end do
    total = comm%sum(total)
  end function sum_within

  !> Without an outflow both parts are kept: a swirl is driven in each, its mass balances, and one cell of each keeps its pressure.
  subroutine two_chambers()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    logical :: converged
    real(wp) :: within
    integer :: i, j, k, m, p

    scene = hollow()
    scene%settings%pressure = 1.0e5_wp
    scene%gravity = [o, -9.81_wp, o]
    call make_gas(comm, scene, gas, outcome)
    do k = 1, gas%boxes%n(3)
      do j = 1, gas%boxes%n(2)
        do i = 1, gas%boxes%n(1)
          associate (x => (gas%boxes%lo + [i, j, k] - 1.5_wp)*0.005_wp - middle)
            gas%drag_source(:, i, j, k) = 1.0e-6_wp*[-x(3), o, x(1)]/edge
          end associate
        end do
      end do
    end do
    do m = 1, 3
      call gas%advance(1.0e-2_wp, converged)
      if (comm%is_root()) call expect(converged, 'two chambers converge')
    end do
    within = sum_within(gas)
    if (comm%is_root()) then
      call expect(gas%space%pockets == 0 .and. gas%levels%n == 2, 'both are kept')
      call expect(within > 1.0e-3_wp, 'the gas of the inner one turns')
    end if
    do p = 1, 2
      if (.not. gas%levels%is_mine(p, gas%boxes%n)) cycle
      associate (c => gas%levels%cell(:, p))
        if (abs(gas%pressure(c(1), c(2), c(3)) - 1.0e5_wp) > 1.0e-6_wp) error stop 'test_pockets: a cell loses its pressure'
      end associate
    end do
    call gas%destroy()
  end subroutine two_chambers

  !> An inflow into a tube whose other end is no outflow.
  subroutine fed_pocket()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome

    scene = hollow()
    scene%surfaces = [new_surface(reshape([tube([middle, o, middle], [o, edge, o], [0.04_wp, 0.04_wp], segments), &
                                           tube([middle, o, middle], [o, edge, o], [0.025_wp, 0.025_wp], segments)], &
                                          [3, 3, 4*segments]))]
    scene%records = [record('in', 'inflow', [o, o, o], [edge, o, edge], velocity=0.1_wp), &
                     record('out', 'outflow', [o, edge, o], [0.01_wp, edge, edge])]
    call make_gas(comm, scene, gas, outcome)
    if (.not. comm%is_root()) return
    call expect(outcome%failed(), 'gas that has no way out is a mistake')
    if (outcome%failed()) call expect(index(outcome%message, 'gas flows into a part of the domain that walls keep from every ' &
                                            //'outflow, the one about (') == 1, 'of which is told')
  end subroutine fed_pocket

end program test_pockets
