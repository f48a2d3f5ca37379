!> Gas that comes in through walls within the domain.
! ranks: 1 2
program test_wall_inflow
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, make_gas, steps
  use gas_settings, only: compressibility
  use kinds, only: wp
  use outcome, only: outcome_t
  use pipe_flow, only: pipe
  use plug_flow, only: edge, walls_record, plane_across, plug_scene, slip_sides, plug_errors
  implicit none

  real(wp), parameter :: o = 0.0_wp
  type(communicator_t) :: comm
  integer :: a, side

  call start_ranks(comm)
  do a = 1, 3
    do side = -1, 1, 2
      call floor(a, side)
    end do
  end do
  call porous_pipe()
  call changing()
  call filling(.true.)
  call filling(.false.)
  call no_way_out()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> A plane across a that cuts cells, slip sides, an outflow: a plug, whose momentum is that with which it comes in.
  !> On two ranks they meet at the face that the gas from the cut cells goes through: if side is -1 these cells are beyond
  !> the box of the face.
  subroutine floor(a, side)
    integer, intent(in) :: a
    integer, intent(in) :: side  !< 1: the gas is above the plane, -1: below

    real(wp), parameter :: speed = 0.6_wp, part = 0.5_wp
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: worst(3)
    logical :: ok

    scene = plug_scene(a, 8)
    scene%walls = [plane_across(a, side, (4 - 0.7_wp*side)*edge)]
    scene%records = [walls_record(scene, 'inflow')]
    scene%records(1)%velocity = speed
    call slip_sides(scene, a, side, 'outflow')
    call make_gas(comm, scene, gas, outcome)
    call expect(gas%boxes%n(a) == 8/comm%size, 'ranks meet beside the floor')
    gas%eps = part
    call gas%accept()
    ok = steps(gas, 4, 2.0e-3_wp)
    worst = plug_errors(comm, gas, a, side*speed/part, o)
    if (comm%is_root()) then
      call expect(ok, 'a plug from a floor converges')
      call expect_close(worst(1), o, 1.0e-9_wp, 'its velocity [m/s]')
      call expect_close(worst(2), o, 1.0e-9_wp, 'it is straight [m/s]')
      call expect_close(worst(3), o, 1.0e-9_wp, 'it needs no pressure, over rho u^2')
      call expect_close(gas%report%inflow/(gas%density*speed*16*edge**2), 1.0_wp, 1.0e-12_wp, 'gas in, reported')
      call expect_close(gas%report%outflow/gas%report%inflow, 1.0_wp, 1.0e-10_wp, 'gas out')
      call expect_close(gas%report%accumulation/gas%report%inflow, o, 1.0e-10_wp, 'none stays')
    end if
    call gas%destroy()
  end subroutine floor

  !> A pipe closed at one end, gas of small Reynolds number through its wall: the mean velocity is 2 V y/R, the pressure falls
  !> by 8 mu/R^2 times that (Poiseuille's profile; Yuan and Finkelstein, Trans. ASME 78 (1956) 719, for Re to 0).
  subroutine porous_pipe()
    real(wp), parameter :: radius = 8.0e-3_wp, speed = 1.0e-3_wp
    integer, parameter :: n = 12, long = 24
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: h, flow, fall, p(2), expected
    logical :: ok

    h = 2*radius/n
    scene%cells = [n + 2, long, n + 2]
    scene%upper = scene%cells*h
    scene%settings%viscosity = 1.0e-3_wp
    scene%numerics%tolerance = 1.0e-9_wp
    scene%numerics%velocity_tolerance = 1.0e-9_wp
    scene%numerics%maximum_iterations = 200
    scene%walls = [pipe(0.5_wp*scene%upper + [0.21_wp*h, o, 0.13_wp*h], 2, radius)]
    scene%records = [walls_record(scene, 'inflow'), &
                     record('closed end', 'slip', [o, o, o], [scene%upper(1), o, scene%upper(3)]), &
                     record('out', 'outflow', [o, scene%upper(2), o], scene%upper)]
    scene%records(1)%velocity = speed
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 8, 0.02_wp)
    flow = gas%density*speed*2*pi*radius*scene%upper(2)
    p = [mean_pressure(gas, long/3), mean_pressure(gas, long - 2)]
    fall = p(1) - p(2)
    expected = 8*scene%settings%viscosity*speed/radius**3*h**2*((long - 2.5_wp)**2 - (long/3 - 0.5_wp)**2)
    if (comm%is_root()) then
      call expect(ok, 'gas through the wall of a pipe converges')
      call expect_close(gas%report%inflow/flow, 1.0_wp, 1.0e-2_wp, 'the wall of a pipe is 2 pi R L')
      call expect_close(gas%report%mass_imbalance, o, 1.0e-9_wp, 'its mass balances')
      call expect_close(fall/expected, 1.0_wp, 2.5e-2_wp, 'pressure along a porous pipe')
    end if
    call gas%destroy()
  end subroutine porous_pipe

  !> Over the open cells of one layer along y [Pa].
  function mean_pressure(gas, layer) result(mean)
    type(gas_t), intent(in) :: gas
    integer, intent(in) :: layer
    real(wp) :: mean

    real(wp) :: sums(2)
    integer :: j

    sums = o
    j = layer + 1 - gas%boxes%lo(2)
    associate (n => gas%boxes%n)
      if (j >= 1 .and. j <= n(2)) then
        associate (part => gas%space%volume(1:n(1), j, 1:n(3)))
          sums = [sum(part*gas%pressure(1:n(1), j, 1:n(3))), sum(part)]
        end associate
      end if
    end associate
    sums = comm%sum(sums)
    mean = sums(1)/sums(2)
  end function mean_pressure

  !> A mass flow through a part of the wall of a pipe, by a table of times.
  subroutine changing()
    real(wp), parameter :: flow = 1.0e-5_wp, factors(4) = [1.0_wp, 1.0_wp, 1.5_wp, 2.0_wp]
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    logical :: ok
    integer :: m

    scene%cells = [10, 12, 10]
    scene%upper = scene%cells*edge
    scene%walls = [pipe(0.5_wp*scene%upper, 2, 4.3_wp*edge)]
    scene%records = [walls_record(scene, 'inflow'), record('out', 'outflow', [o, scene%upper(2), o], scene%upper)]
    scene%records(1)%upper(2) = 5*edge
    scene%records(1)%mass_flow = flow
    scene%records(1)%times = [2.0e-3_wp, 4.0e-3_wp]
    scene%records(1)%factors = [1.0_wp, 2.0_wp]
    call make_gas(comm, scene, gas, outcome)
    do m = 1, 4
      gas%time = (m - 1)*1.0e-3_wp
      ok = steps(gas, 1, 1.0e-3_wp)
      if (.not. comm%is_root()) cycle
      call expect(ok, 'a changing flow through a wall converges')
      call expect_close(gas%report%inflow, factors(m)*flow, 1.0e-12_wp, 'and is as asked for [kg/s]')
    end do
    if (comm%is_root()) call expect(any(gas%seep(1:2, 2:3, :) > o) .or. comm%size > 1, 'through the wall')
    associate (j => 7 - gas%boxes%lo(2))
      if (j <= gas%boxes%n(2)) call expect(.not. any(gas%seep(:, max(j, 1):gas%boxes%n(2), :) > o), 'not above the box')
    end associate
    call gas%destroy()
  end subroutine changing

  !> An ideal gas into a closed vessel: the mass grows by the mass flow; by velocity times area times the density when the step
  !> begins, if that is what is given.
  subroutine filling(by_mass)
    logical, intent(in) :: by_mass

    real(wp), parameter :: dt = 1.0e-3_wp
    integer, parameter :: count = 5
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: start, wall, expected, mass
    logical :: ok

    scene%cells = [10, 12, 10]
    scene%upper = scene%cells*edge
    scene%settings%density_law = 'ideal'
    scene%settings%molar_mass = 0.029_wp
    scene%settings%temperature = 290.0_wp
    scene%settings%reference_pressure = 1.0e5_wp
    scene%settings%density = compressibility(scene%settings)*1.0e5_wp
    scene%numerics%tolerance = 1.0e-11_wp
    scene%numerics%maximum_iterations = 100
    scene%walls = [pipe(0.5_wp*scene%upper, 2, 4.3_wp*edge)]
    scene%records = [walls_record(scene, 'inflow')]
    if (by_mass) scene%records(1)%mass_flow = 1.0e-4_wp
    if (.not. by_mass) scene%records(1)%velocity = 0.1_wp
    call make_gas(comm, scene, gas, outcome)
    start = mass_of(gas)
    wall = comm%sum(sum(gas%boundary%walls%area))
    ok = steps(gas, count, dt)
    mass = mass_of(gas)
    expected = start + count*dt*1.0e-4_wp
    if (.not. by_mass) expected = start*(1 + dt*0.1_wp*wall/gas%space%open_volume)**count
    if (comm%is_root()) then
      call expect(ok .and. mass > 1.05_wp*start, 'a vessel is filled through its wall')
      call expect_close(mass/expected, 1.0_wp, 1.0e-6_wp, 'by as much as flows in')
      call expect_close(gas%report%mass_imbalance, o, 1.0e-9_wp, 'and its mass balances')
    end if
    call gas%destroy()
  end subroutine filling

  function mass_of(gas) result(mass)
    type(gas_t), intent(in) :: gas
    real(wp) :: mass

    associate (n => gas%boxes%n)
      mass = comm%sum(sum(gas%volume(1:n(1), 1:n(2), 1:n(3))*gas%ideal%density(1:n(1), 1:n(2), 1:n(3)), .not. gas%space%closed))
    end associate
  end function mass_of

  !> Gas into a part that no outflow drains, and a box that holds no wall, are mistakes.
  subroutine no_way_out()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome, other, shut_in

    scene%cells = [10, 12, 10]
    scene%upper = scene%cells*edge
    scene%walls = [pipe(0.5_wp*scene%upper, 2, 4.3_wp*edge)]
    scene%records = [walls_record(scene, 'inflow')]
    scene%records(1)%velocity = 1.0_wp
    call make_gas(comm, scene, gas, outcome)
    if (comm%is_root()) call expect(index(outcome%message, 'no &boundary is an outflow') > 0, 'gas in, none out')
    scene%records = [scene%records, record('out', 'outflow', [o, scene%upper(2), o], scene%upper)]
    scene%records(1)%lower = 0.45_wp*scene%upper
    scene%records(1)%upper = 0.55_wp*scene%upper
    call make_gas(comm, scene, gas, other)
    if (comm%is_root()) call expect(index(other%message, 'no cell with a wall') > 0, 'no wall in the box')
    ! a disc as wide as the vessel, gas from its lower face
    scene%walls(1)%radius = 2*scene%upper(1)
    scene%walls(1)%length = 2.3_wp*edge
    scene%walls(1)%gas_side = 'outside'
    scene%records(1)%lower = o
    scene%records(1)%upper = [scene%upper(1), scene%walls(1)%point(2) + edge, scene%upper(3)]
    call make_gas(comm, scene, gas, shut_in)
    if (comm%is_root()) call expect(index(shut_in%message, 'keep from every outflow') > 0, 'gas into a part without a way out')
  end subroutine no_way_out

end program test_wall_inflow
