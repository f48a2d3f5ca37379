!> Flows of an ideal gas of one temperature that have a closed form: at rest under gravity, filling a vessel, swinging in a tube,
!> pressed through a bed.
module compressible_flows
  use boundary_settings, only: boundary_settings_t
  use communicator, only: communicator_t
  use constants, only: pi
  use coupling_scene, only: bed_t => scene_t, build, add, refill, recouple, viscosity
  use coupling_settings, only: coupling_settings_t
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, make_gas, steps, set_cells, wavy_void
  use gas_settings, only: gas_settings_t, compressibility, make_ideal
  use kinds, only: wp
  use outcome, only: outcome_t
  use parcels, only: before_row
  implicit none
  private
  public :: ideal_gas, tube, open_end, atmosphere_error, filled_vessel, sound, bed_error, bed_pressure, ergun_error

  !> Air at 20 C and 1 atm, and what it is then.
  real(wp), parameter, public :: molar_mass = 0.02896_wp, temperature = 293.15_wp, atmosphere = 101325.0_wp
  real(wp), parameter, public :: specific = 8.314462618_wp*temperature/molar_mass  !< R T/M, c squared [m2/s2]
  real(wp), parameter :: o = 0.0_wp

contains

  !> The settings of air, at a pressure above the reference.
  function ideal_gas(reference, pressure) result(settings)
    real(wp), intent(in) :: reference, pressure  !< [Pa]
    type(gas_settings_t) :: settings

    settings%molar_mass = molar_mass
    settings%temperature = temperature
    settings%reference_pressure = reference
    settings%pressure = pressure
    call make_ideal(settings)
  end function ideal_gas

  !> A tube of square cross-section along an axis, n cells long and one wide, closed, in which gas slips.
  function tube(axis, length, edge, n) result(scene)
    integer, intent(in) :: axis, n
    real(wp), intent(in) :: length, edge  !< [m]
    type(scene_t) :: scene

    integer :: a, end
    real(wp) :: lower(3), upper(3)

    scene%upper = edge
    scene%upper(axis) = length
    scene%cells(axis) = n
    scene%numerics%tolerance = 1.0e-10_wp
    scene%numerics%velocity_tolerance = 1.0e-10_wp
    scene%settings = ideal_gas(atmosphere, o)
    allocate (scene%records(0))
    do a = 1, 3
      if (a == axis) cycle
      do end = 1, 2
        lower = o
        upper = scene%upper
        lower(a) = merge(o, scene%upper(a), end == 1)
        upper(a) = lower(a)
        scene%records = [scene%records, record('side', 'slip', lower, upper)]
      end do
    end do
  end function tube

  !> Open a tube at its upper end, to a pressure.
  subroutine open_end(scene, axis, pressure)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: axis
    real(wp), intent(in) :: pressure  !< [Pa]

    real(wp) :: lower(3)

    lower = o
    lower(axis) = scene%upper(axis)
    scene%records = [scene%records, record('end', 'outflow', lower, scene%upper, pressure=pressure)]
  end subroutine open_end

  !> A column a scale height R T/(M g) high, in a bed, comes to rest from the same pressure everywhere: the largest distance from
  !> p = p_0 exp(-g z/(R T/M)), p_0 by the pressure above, or by the mass in a closed one.
  subroutine atmosphere_error(comm, axis, n, open, worst, ok)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: axis, n
    logical, intent(in) :: open
    real(wp), intent(out) :: worst
    logical, intent(out) :: ok  !< whether the steps converged

    real(wp), parameter :: g = 9.81_wp, height = specific/g
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: z, bottom, p
    integer :: i, cell(3)

    scene = tube(axis, height, 0.1_wp*height, n)
    scene%gravity(axis) = -g
    if (open) call open_end(scene, axis, o)
    call make_gas(comm, scene, gas, outcome)
    associate (m => gas%boxes%n)
      gas%drag(1:m(1), 1:m(2), 1:m(3)) = 0.3_wp*gas%density*gas%volume(1:m(1), 1:m(2), 1:m(3))
    end associate
    ok = steps(gas, 60, 8.0_wp)
    ok = steps(gas, 30, 100.0_wp) .and. ok
    bottom = merge(exp(1.0_wp), 1/(1 - exp(-1.0_wp)), open)*atmosphere
    worst = o
    cell = 1
    do i = 1, gas%boxes%n(axis)
      cell(axis) = i
      z = (gas%boxes%lo(axis) + i - 1.5_wp)/n
      p = atmosphere + gas%pressure(cell(1), cell(2), cell(3))
      worst = max(worst, abs(p/(bottom*exp(-z)) - 1))
    end do
    worst = comm%max(worst)
    call gas%destroy()
  end subroutine atmosphere_error

  !> Gas of a given mass flow fills a closed vessel of uneven void fraction through a part of its floor: the growth of the mean
  !> pressure over that of p V = m R T/M, and of the mass in it over what has flowed in.
  subroutine filled_vessel(comm, pressure_ratio, mass_ratio, ok)
    type(communicator_t), intent(in) :: comm
    real(wp), intent(out) :: pressure_ratio, mass_ratio
    logical, intent(out) :: ok  !< whether the steps converged

    real(wp), parameter :: edge = 0.02_wp, flow = 2.0e-5_wp, dt = 1.0e-3_wp
    integer, parameter :: count = 50
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: sums(4), reported
    integer :: step
    logical :: converged

    scene%cells = [6, 10, 4]
    scene%upper = edge*scene%cells
    scene%settings = ideal_gas(atmosphere, o)
    scene%numerics%tolerance = 1.0e-12_wp
    scene%numerics%velocity_tolerance = 1.0e-9_wp
    scene%records = [record('jet', 'inflow', [edge, o, o], [3*edge, o, 2*edge])]
    scene%records(1)%mass_flow = flow
    call make_gas(comm, scene, gas, outcome)
    call set_cells(gas%boxes, wavy_void, gas%eps)
    call gas%accept()
    sums(1:2) = contents(gas)
    reported = o
    ok = .true.
    do step = 1, count
      call gas%advance(dt, converged)
      call gas%accept()
      ok = ok .and. converged
      reported = reported + dt*gas%report%accumulation
    end do
    sums(3:4) = contents(gas)
    sums = comm%sum(sums)
    pressure_ratio = (sums(3) - sums(1))/(count*dt*flow*specific)
    mass_ratio = reported/(count*dt*flow)
    call gas%destroy()

  contains

    !> Sums over my cells of p eps V and of eps V.
    function contents(gas) result(pair)
      type(gas_t), intent(in) :: gas
      real(wp) :: pair(2)

      associate (n => gas%boxes%n)
        associate (room => gas%eps(1:n(1), 1:n(2), 1:n(3))*gas%volume(1:n(1), 1:n(2), 1:n(3)))
          pair = [sum(gas%pressure(1:n(1), 1:n(2), 1:n(3))*room), sum(room)]
        end associate
      end associate
    end function contents

  end subroutine filled_vessel

  !> The slowest wave in a closed tube 1 m long, at half an atmosphere more than the pressure of &gas, over one period in steps of
  !> a part of it: its frequency [Hz] by the first and third zero of the pressure at the end, and the largest distance of that
  !> pressure, over its first, from what implicit steps make of a wave on the cells,
  !>
  !>   p_m = p_0 (1 + x^2)^(-m/2) cos(m atan(x)),    x = w dt,    w = (2 c/h) sin(pi h/(2 L)).
  subroutine sound(comm, axis, n, parts, frequency, worst, ok)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: axis, n
    integer, intent(in) :: parts  !< of a period
    real(wp), intent(out) :: frequency, worst
    logical, intent(out) :: ok    !< whether the steps converged

    real(wp), parameter :: swing = 1.0_wp, level = 0.5_wp*atmosphere  !< [Pa]
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: dt, x, p(0:parts), zero(2)
    integer :: m, found
    logical :: converged

    scene = tube(axis, 1.0_wp, 0.1_wp, n)
    scene%settings%viscosity = 1.0e-9_wp
    call make_gas(comm, scene, gas, outcome)
    call start_wave(gas, axis, n, level, swing)
    dt = 2/sqrt(specific)/parts
    x = 2*n*sqrt(specific)*sin(0.5_wp*pi/n)*dt
    ok = .true.
    p(0) = end_pressure(gas, comm) - level
    found = 0
    zero = o
    worst = o
    do m = 1, parts
      call gas%advance(dt, converged)
      call gas%accept()
      ok = ok .and. converged
      p(m) = end_pressure(gas, comm) - level
      worst = max(worst, abs(p(m)/p(0) - (1 + x**2)**(-0.5_wp*m)*cos(m*atan(x))))
      if (p(m)*p(m - 1) > o .or. found == 2) cycle
      found = found + 1
      zero(found) = (m - p(m)/(p(m) - p(m - 1)))*dt
    end do
    frequency = 0.5_wp/(zero(2) - zero(1))
    call gas%destroy()
  end subroutine sound

  !> Half a wave of pressure along a tube.
  subroutine start_wave(gas, axis, n, level, swing)
    type(gas_t), intent(inout) :: gas
    integer, intent(in) :: axis, n
    real(wp), intent(in) :: level, swing  !< [Pa]

    integer :: i, j, k, place(3)

    do k = 1, gas%boxes%n(3)
      do j = 1, gas%boxes%n(2)
        do i = 1, gas%boxes%n(1)
          place = gas%boxes%lo + [i, j, k] - 1
          gas%pressure(i, j, k) = level + swing*cos(pi*(place(axis) - 0.5_wp)/n)
        end do
      end do
    end do
    call gas%halo%exchange(gas%pressure)
  end subroutine start_wave

  !> Pressure in the first cell of the grid.
  function end_pressure(gas, comm) result(p)
    type(gas_t), intent(in) :: gas
    type(communicator_t), intent(in) :: comm
    real(wp) :: p

    p = o
    if (all(gas%boxes%lo == 1)) p = gas%pressure(1, 1, 1)
    p = comm%sum(p)
  end function end_pressure

  !> Gas is pressed through a bed with the drag b u per volume from about twice the pressure of its end: the largest relative
  !> distance from
  !>
  !>   eps psi (p^2 - p_end^2)/2 = b G (L - z)/eps + G^2/eps ln(p/p_end),
  !>
  !> G the mass flow over the whole cross-section. The last term is the gas's acceleration, a fiftieth.
  subroutine bed_error(comm, axis, n, worst, ok, iterations)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: axis, n
    real(wp), intent(out) :: worst
    logical, intent(out) :: ok          !< whether the steps converged
    integer, intent(out) :: iterations  !< of the step with most

    real(wp), parameter :: eps = 0.4_wp, length = 0.5_wp, edge = 0.01_wp, flow = 28.0_wp, resistance = 2000.0_wp
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: p
    integer :: i, step, cell(3)
    logical :: converged

    scene = tube(axis, length, edge, n)
    scene%numerics%maximum_iterations = 100
    call open_end(scene, axis, o)
    scene%records = [scene%records, record('in', 'inflow', [o, o, o], edge*merge([0, 0, 0], [1, 1, 1], [1, 2, 3] == axis))]
    scene%records(size(scene%records))%mass_flow = flow*edge**2
    call make_gas(comm, scene, gas, outcome)
    associate (m => gas%boxes%n)
      gas%eps(1:m(1), 1:m(2), 1:m(3)) = eps
      gas%drag(1:m(1), 1:m(2), 1:m(3)) = resistance*gas%volume(1:m(1), 1:m(2), 1:m(3))
    end associate
    call gas%accept()
    ok = .true.
    iterations = 0
    do step = 1, 10
      call gas%advance(0.02_wp*step**2, converged)
      call gas%accept()
      ok = ok .and. converged
      iterations = max(iterations, gas%report%iterations)
    end do
    worst = o
    cell = 1
    do i = 1, gas%boxes%n(axis)
      cell(axis) = i
      p = bed_pressure(resistance, 1/specific, eps, flow, length*(1 - (gas%boxes%lo(axis) + i - 1.5_wp)/n), atmosphere)
      worst = max(worst, abs((atmosphere + gas%pressure(cell(1), cell(2), cell(3)))/p - 1))
    end do
    worst = comm%max(worst)
    call gas%destroy()
  end subroutine bed_error

  !> The pressure at a distance upstream of the end of a bed, by the equation of bed_error [Pa].
  pure function bed_pressure(resistance, psi, eps, flow, distance, end) result(p)
    real(wp), intent(in) :: resistance  !< b, drag over volume and velocity [kg/(m3 s)]
    real(wp), intent(in) :: psi, eps, flow, distance, end  !< [s2/m2], [-], [kg/(m2 s)], [m], [Pa]
    real(wp) :: p

    integer :: i

    p = end
    do i = 1, 60
      p = sqrt(end**2 + 2/(eps*psi)*(resistance*flow*distance/eps + flow**2/eps*log(p/end)))
    end do
  end function bed_pressure

  !> Gas is pressed through a packed bed half a metre high of heavy grains, with Ergun's drag at the density of each place, from
  !> two and a half times the pressure of its end: the largest relative distance from the equation of bed_error with
  !>
  !>   b = eps^2 (150 phi^2 mu/(d^2 eps^3) + 1.75 phi G/(d eps^3)).
  subroutine ergun_error(comm, n, worst, ok)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: n
    real(wp), intent(out) :: worst
    logical, intent(out) :: ok  !< whether the steps converged

    real(wp), parameter :: d = 2.0e-4_wp, eps = 0.45_wp, flow = 2.0_wp, length = 0.5_wp, edge = 0.5_wp*length
    type(bed_t) :: bed
    type(boundary_settings_t) :: records(2)
    type(gas_settings_t) :: air
    type(coupling_settings_t) :: settings
    real(wp) :: b, p
    integer :: i, step
    logical :: converged

    air = ideal_gas(atmosphere, o)
    call build(comm, edge, [1, n, 1], [.true., .false., .true.], 'ergun', bed)
    records = [record('in', 'inflow', [o, o, o], [edge, o, edge]), &
               record('out', 'outflow', [o, length, o], [edge, length, edge], pressure=o)]
    records(1)%mass_flow = flow*edge**2
    call refill(bed, records, air)
    settings%drag = 'ergun'
    call recouple(bed, settings, air)
    do i = 1, n
      call add(bed, bed%mesh%finest*([1, i, 1] - 0.5_wp), [o, o, o], d, 1.0e12_wp, &
               (1 - eps)*product(bed%mesh%finest)/(pi/6*d**3))
    end do
    ! held for a second: nothing accelerates them but drag
    bed%parcels%coupled(:, :bed%parcels%n) = o
    bed%parcels%coupled(before_row + 3, :bed%parcels%n) = 1.0_wp
    call bed%coupling%map_void_fraction(bed%parcels, bed%gas)
    call bed%gas%accept()
    ok = .true.
    do step = 1, 12
      call bed%coupling%prepare(bed%parcels, bed%gas, 0.1_wp*step, as_seen=.false.)
      call bed%gas%advance(0.1_wp*step, converged)
      call bed%gas%accept()
      ok = ok .and. converged
    end do
    worst = o
    b = (150*(1 - eps)**2*viscosity/d**2 + 1.75_wp*(1 - eps)*flow/d)/eps
    do i = 1, bed%gas%boxes%n(2)
      p = bed_pressure(b, 1/specific, eps, flow, length*(1 - (bed%gas%boxes%lo(2) + i - 1.5_wp)/n), atmosphere)
      worst = max(worst, abs((atmosphere + bed%gas%pressure(1, i, 1))/p - 1))
    end do
    worst = comm%max(worst)
    call bed%gas%destroy()
  end subroutine ergun_error

end module compressible_flows
