!> What moves the gas: inflows that change and that have a profile, walls that move, what drives it along periodic directions.
program test_gas_boundary
  use cavity_flow, only: cavity_t, steady_cavity
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use compressible_flows, only: ideal_gas
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, channel, make_gas, set_cells, steps, uneven_drag, wavy_void
  use kinds, only: wp
  use outcome, only: outcome_t
  implicit none

  real(wp), parameter :: o = 0.0_wp, edge = 2.0e-3_wp
  type(communicator_t) :: comm

  call start_ranks(comm)
  call changing_inflow()
  call measures_of_inflow()
  call bent_inflow()
  call sliding_walls()
  call driven_bed([8, 16, 4], [o, 1.0e-4_wp, o], 'upwards')
  call driven_bed([8, 16, 4], [2.0e-5_wp, o, -4.0e-5_wp], 'across')
  call layers_in_series()
  call sucked_in('constant')
  call sucked_in('ideal')
  call given_drop()
  call forgotten_drop()
  if (comm%size == 1) call edge_of_a_plate()
  if (comm%size == 1) call small_cavity()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> The inflow of a step is that at its end; linear between the times, constant before and after, a jump at a time given twice.
  subroutine changing_inflow()
    real(wp), parameter :: starts(8) = [-0.5_wp, 0.05_wp, 0.9_wp, 1.3_wp, 1.85_wp, 1.9_wp, 2.4_wp, 7.0_wp]
    real(wp), parameter :: factors(8) = [0.5_wp, 0.65_wp, 1.5_wp, 1.5_wp, 1.5_wp, 0.2_wp, 0.2_wp, 0.2_wp]
    real(wp), parameter :: unit_time = 1.0e-2_wp, dt = 0.1_wp*unit_time
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    integer :: m
    logical :: converged

    scene = channel(edge)
    scene%records(1)%times = unit_time*[o, 1.0_wp, 2.0_wp, 2.0_wp]
    scene%records(1)%factors = [0.5_wp, 1.5_wp, 1.5_wp, 0.2_wp]
    call make_gas(comm, scene, gas, outcome)
    do m = 1, size(starts)
      gas%time = unit_time*starts(m)
      call gas%advance(dt, converged)
      call gas%accept()
      if (.not. comm%is_root()) cycle
      call expect(converged, 'a changing inflow converges')
      call expect_close(gas%report%inflow, factors(m)*0.5_wp*1.2_wp*32*edge**2, 1.0e-12_wp, 'inflow by its table [kg/s]')
      call expect_close(gas%report%outflow, gas%report%inflow, 1.0e-5_wp, 'and out')
    end do
    call gas%destroy()
  end subroutine changing_inflow

  !> The same inflow as a velocity, a mass flow and a volume flow, through two jets of different width.
  subroutine measures_of_inflow()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    integer :: m
    logical :: converged

    do m = 1, 3
      scene = channel(edge)
      scene%records(1)%upper(1) = 2*edge
      scene%records = [scene%records, record('jet', 'inflow', [5*edge, o, o], [6*edge, o, scene%upper(3)], velocity=2.0_wp)]
      associate (jet => scene%records(3))
        if (m > 1) jet%velocity = -huge(1.0_wp)
        if (m == 2) jet%mass_flow = 2.0_wp*1.2_wp*4*edge**2
        if (m == 3) jet%volume_flow = 2.0_wp*4*edge**2
      end associate
      call make_gas(comm, scene, gas, outcome)
      call gas%advance(1.0e-3_wp, converged)
      if (comm%is_root()) call expect_close(gas%report%inflow, 1.2_wp*(8*0.5_wp + 4*2.0_wp)*edge**2, 1.0e-12_wp, 'two jets [kg/s]')
      call gas%destroy()
    end do
  end subroutine measures_of_inflow

  !> A parabola over the width of its region, uniform along the periodic direction, of the given mean.
  subroutine bent_inflow()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: s, worst, scale
    integer :: i
    logical :: converged

    scene = channel(edge)
    scene%records(1)%lower(1) = 2*edge
    scene%records(1)%profile = 'parabola'
    call make_gas(comm, scene, gas, outcome)
    call gas%advance(1.0e-3_wp, converged)
    scale = 6/sum([(((i - 0.5_wp)/6)*(1 - (i - 0.5_wp)/6), i=1, 6)])
    worst = o
    if (gas%boxes%lo(2) == 1) then
      do i = 1, gas%boxes%n(1)
        s = (gas%boxes%lo(1) + i - 3.5_wp)/6
        worst = max(worst, maxval(abs(gas%velocity(i, 0, 1:gas%boxes%n(3), 2) - 0.5_wp*scale*max(o, s*(1 - s)))))
      end do
    end if
    worst = comm%max(worst)
    if (comm%is_root()) then
      call expect_close(worst, o, 1.0e-14_wp, 'a parabola flows in [m/s]')
      call expect_close(gas%report%inflow, 0.5_wp*1.2_wp*24*edge**2, 1.0e-12_wp, 'its mean is the velocity [kg/s]')
    end if
    call gas%destroy()
  end subroutine bent_inflow

  !> Between a plate at rest and one that moves, on either end of each direction and along both others, the flow is a straight
  !> line; in a direction one cell wide it is half the wall's velocity.
  subroutine sliding_walls()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: worst, expected(3)
    integer :: b, end, cells, i, j, k, place(3)
    logical :: ok

    do b = 1, 3
      do end = 1, 2
        do cells = 1, 6, 5
          scene = plates(b, end, cells)
          call make_gas(comm, scene, gas, outcome)
          ok = steps(gas, 3, 1.0e5_wp)
          worst = o
          do k = 1, gas%boxes%n(3)
            do j = 1, gas%boxes%n(2)
              do i = 1, gas%boxes%n(1)
                place = gas%boxes%lo + [i, j, k] - 1
                expected = scene%records(1)%wall_velocity*abs((place(b) - 0.5_wp)/cells - merge(1, 0, end == 1))
                expected(b) = gas%velocity(i, j, k, b)
                worst = max(worst, maxval(abs(gas%velocity(i, j, k, :) - expected)))
              end do
            end do
          end do
          worst = comm%max(worst)
          if (comm%is_root()) call expect(ok, 'sliding walls converge')
          if (comm%is_root()) call expect_close(worst, o, 1.0e-8_wp, 'between sliding walls [m/s]')
          call gas%destroy()
        end do
      end do
    end do
  end subroutine sliding_walls

  !> Plates across b, the one at `end` moving.
  function plates(b, end, cells) result(scene)
    integer, intent(in) :: b, end, cells
    type(scene_t) :: scene

    real(wp) :: wall(3, 2)

    scene%cells = 4
    scene%cells(b) = cells
    scene%upper = scene%cells*edge
    scene%periodic = .true.
    scene%periodic(b) = .false.
    scene%numerics%velocity_tolerance = 1.0e-10_wp
    scene%settings%viscosity = 1.0e-3_wp
    wall(:, 1) = o
    wall(:, 2) = scene%upper
    wall(b, :) = merge(o, scene%upper(b), end == 1)
    allocate (scene%records(1))
    scene%records(1) = record('plate', 'no_slip', wall(:, 1), wall(:, 2))
    scene%records(1)%wall_velocity = [0.01_wp, -0.02_wp, 0.03_wp]
    scene%records(1)%wall_velocity(b) = o
  end function plates

  !> In a periodic bed of uneven void fraction and drag the flow given is there to the last digits, in one of several
  !> directions and none in the others, and the drop balances the drag.
  subroutine driven_bed(cells, flow, name)
    integer, intent(in) :: cells(3)
    real(wp), intent(in) :: flow(3)  !< [kg/s]
    character(len=*), intent(in) :: name

    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: found(3), balance(3), gradient(3)
    real(wp), allocatable :: field(:,:,:,:)
    integer :: a
    logical :: ok

    scene%cells = cells
    scene%upper = cells*edge
    scene%periodic = .true.
    scene%settings%flow_given = .true.
    scene%settings%mass_flow = flow
    scene%numerics%velocity_tolerance = 1.0e-9_wp
    scene%numerics%tolerance = 1.0e-9_wp
    allocate (scene%records(0))
    call make_gas(comm, scene, gas, outcome)
    call set_cells(gas%boxes, wavy_void, gas%eps)
    call set_cells(gas%boxes, uneven_drag, gas%drag)
    call gas%accept()
    ok = steps(gas, 8, 1.0e-2_wp)
    associate (n => gas%boxes%n)
      found = comm%sum([(sum(gas%flux(1:n(1), 1:n(2), 1:n(3), a))/cells(a), a=1, 3)])
      allocate (field(3, n(1), n(2), n(3)))
      call gas%cell_pressure_gradient(field)
      gradient = comm%sum(sum(reshape(field, [3, product(n)]), dim=2))*product(gas%mesh%finest)
    end associate
    balance = gas%drag_total()
    if (comm%is_root()) then
      call expect(ok, 'driven bed converges, '//name)
      call expect_close(real(gas%report%iterations, wp), o, 12.0_wp, 'in a few iterations')
      do a = 1, 3
        call expect_close(found(a) - flow(a), o, 1.0e-10_wp*maxval(abs(flow)), 'the flow given [kg/s]')
        call expect_close(gradient(a) + gas%driving%drop(a)/scene%upper(a)*product(scene%upper), o, &
                          1.0e-9_wp*maxval(abs(balance)), 'the mean pressure gradient of cells is that of the drop [N]')
      end do
      call expect(maxval(gas%driving%drop*sign(1.0_wp, flow), mask=abs(flow) > o) > o, 'it falls where the gas flows to')
    end if
    call gas%destroy()
  end subroutine driven_bed

  !> Layers of different drag across the flow: the drop is the sum of theirs, found at once although one resists a
  !> thousand times as much as the other.
  subroutine layers_in_series()
    real(wp), parameter :: flow = 1.0e-5_wp
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: expected, velocity
    integer :: j
    logical :: ok

    scene%cells = [2, 12, 2]
    scene%upper = scene%cells*edge
    scene%periodic = .true.
    scene%settings%flow_given = .true.
    scene%settings%mass_flow = o
    scene%settings%mass_flow(2) = flow
    scene%settings%viscosity = o
    scene%numerics%velocity_tolerance = 1.0e-9_wp
    allocate (scene%records(0))
    call make_gas(comm, scene, gas, outcome)
    do j = 1, gas%boxes%n(2)
      gas%drag(:, j, :) = merge(1.0e-3_wp, 1.0e-6_wp, gas%boxes%lo(2) + j - 1 <= 4)
    end do
    call gas%advance(1.0e-3_wp, ok)
    call gas%accept()
    if (comm%is_root()) call expect_close(real(gas%report%iterations, wp), o, 8.0_wp, 'a start in a few iterations')
    ok = steps(gas, 3, 1.0e-3_wp)
    velocity = flow/(1.2_wp*4*edge**2)
    expected = velocity*(4*1.0e-3_wp + 8*1.0e-6_wp)/edge**2
    if (comm%is_root()) then
      call expect(ok, 'layers converge')
      call expect_close(real(gas%report%iterations, wp), o, 3.0_wp, 'in a few iterations')
      call expect_close(gas%driving%drop(2), expected, 1.0e-7_wp, 'layers in series [Pa]')
    end if
    call gas%destroy()
  end subroutine layers_in_series

  !> Gas that a pressure sucks in brings no momentum, so that its pressure falls by rho u^2 when it enters, and by nothing
  !> more in a duct without friction. A pressure so small hardly compresses an ideal gas.
  subroutine sucked_in(law)
    character(len=*), intent(in) :: law

    real(wp), parameter :: fall = 0.3_wp  !< [Pa]
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: speed
    logical :: ok

    scene%cells = [4, 8, 4]
    scene%upper = scene%cells*edge
    if (law == 'ideal') scene%settings = ideal_gas(reference=101325.0_wp, pressure=o)
    scene%settings%viscosity = o
    scene%numerics%velocity_tolerance = 1.0e-9_wp
    associate (top => scene%upper)
      scene%records = [record('in', 'outflow', [o, o, o], [top(1), o, top(3)], pressure=fall), &
                       record('out', 'outflow', [o, top(2), o], top, pressure=o)]
    end associate
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 300, 1.0e-3_wp)
    associate (n => gas%boxes%n)
      speed = comm%max(maxval(gas%velocity(1:n(1), 1:n(2), 1:n(3), 2)))
    end associate
    if (comm%is_root()) then
      call expect(ok, 'gas is sucked in, density: '//law)
      call expect_close(speed, sqrt(fall/gas%density), 1.0e-5_wp, 'and its momentum is made from the pressure [m/s]')
    end if
    call gas%destroy()
  end subroutine sucked_in

  !> A pressure drop does what gravity of the same strength does.
  subroutine given_drop()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: flow(2)
    integer :: m
    logical :: ok

    do m = 1, 2
      scene = scene_t(cells=[6, 8, 4], upper=[6, 8, 4]*edge, periodic=[.false., .true., .true.])
      if (m == 1) scene%settings%pressure_drop(2) = 3.0_wp
      if (m == 2) scene%gravity(2) = 3.0_wp/(1.2_wp*8*edge)
      scene%numerics%velocity_tolerance = 1.0e-9_wp
      allocate (scene%records(0))
      call make_gas(comm, scene, gas, outcome)
      call set_cells(gas%boxes, uneven_drag, gas%drag)
      ok = steps(gas, 3, 1.0e-3_wp)
      if (comm%is_root()) call expect(ok, 'driven gas converges')
      associate (n => gas%boxes%n)
        flow(m) = comm%sum(sum(gas%flux(1:n(1), 1:n(2), 1:n(3), 2)))/8
      end associate
      call gas%destroy()
    end do
    if (comm%is_root()) call expect_close(flow(1), flow(2), 1.0e-7_wp, 'pressure drop and gravity [kg/s]')
  end subroutine given_drop

  !> A step that does not converge leaves no drop behind.
  subroutine forgotten_drop()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: before
    logical :: converged

    scene = scene_t(cells=[6, 8, 4], upper=[6, 8, 4]*edge, periodic=[.false., .true., .true.])
    scene%settings%flow_given = .true.
    scene%settings%mass_flow = o
    scene%settings%mass_flow(2) = 1.0e-4_wp
    allocate (scene%records(0))
    call make_gas(comm, scene, gas, outcome)
    call gas%advance(1.0e-3_wp, converged)
    before = gas%driving%drop(2)
    call gas%accept()
    gas%numerics%velocity_tolerance = 1.0e-16_wp
    gas%numerics%maximum_iterations = 1
    gas%driving%flow(2) = 2.0e-4_wp
    call gas%advance(1.0e-3_wp, converged)
    if (comm%is_root()) then
      call expect(before > o .and. .not. converged, 'a step that fails')
      call expect(.not. abs(gas%driving%drop(2) - before) > o, 'leaves no trace in the drop')
    end if
    call gas%destroy()
  end subroutine forgotten_drop

  !> Half of a floor is a plate to which gas sticks: of a face above its edge, a half of that.
  subroutine edge_of_a_plate()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    logical :: converged

    scene%cells = [8, 6, 4]
    scene%upper = scene%cells*edge
    associate (top => scene%upper)
      scene%records = [record('plate', 'no_slip', [o, o, o], [0.5_wp*top(1), o, top(3)]), &
                       record('ice', 'slip', [0.5_wp*top(1), o, o], [top(1), o, top(3)])]
    end associate
    call make_gas(comm, scene, gas, outcome)
    call gas%advance(1.0e-3_wp, converged)
    associate (along => gas%wall(1, 2, 1)%conductance(:, 1, 2)/(gas%viscosity*edge), &
               across => gas%wall(1, 2, 3)%conductance(:, 1, 2)/(gas%viscosity*edge))
      call expect_close(maxval(abs(along(2:8) - [1.0_wp, 1.0_wp, 1.0_wp, 0.5_wp, o, o, o])), o, 1.0e-12_wp, 'half of a plate')
      call expect_close(maxval(abs(across - [1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, o, o, o, o])), o, 1.0e-12_wp, 'along its edge')
    end associate
    call gas%destroy()
  end subroutine edge_of_a_plate

  !> The cavity of verify_cavity on few cells: the strongest backflow, which is 0.2140 on many.
  subroutine small_cavity()
    type(cavity_t) :: cavity

    call steady_cavity(comm, 32, 100.0_wp, 'van_leer', 0.25_wp, 1.0e-5_wp, cavity)
    call expect(cavity%steady, 'a steady cavity')
    call expect_close(cavity%u_min(), -0.2140_wp, 0.01_wp, 'backflow in the cavity')
  end subroutine small_cavity

end program test_gas_boundary
