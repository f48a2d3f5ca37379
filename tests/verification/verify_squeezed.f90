!> Two balls squeezed between floor and ceiling, against their equations of motion solved with steps so short that
!> the solution counts as exact.
program verify_squeezed
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use check, only: finish
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, run
  use kinds, only: wp
  use report, only: check_value, point
  use solids, only: solids_t
  use spring_contact, only: damping_ratio
  implicit none

  real(wp), parameter :: radius = 0.5e-3_wp, gap = 1.8e-3_wp, stiffness = 5.0e4_wp, gravity = 9.80665_wp
  real(wp), parameter :: density(2) = [2.0e4_wp, 1.0e4_wp], start(2) = [0.45e-3_wp, 1.35e-3_wp]
  real(wp), parameter :: mass(2) = density*4*pi/3*radius**3, end_time = 1.0e-3_wp
  type(communicator_t) :: comm
  integer :: i

  call start_ranks(comm)
  do i = 10, 5, -1
    call squeeze(0.1_wp*i)
  end do
  call order('order_squeezed_elastic', 1.0_wp)
  call order('order_squeezed_damped', 0.8_wp)
  call finish()
  call stop_ranks()

contains

  !> Both balls with fifty steps in the shortest possible collision [nm].
  subroutine squeeze(restitution)
    real(wp), intent(in) :: restitution  !< [-]

    real(wp) :: error(2)
    character(len=3) :: e

    write (e, '(f3.1)') restitution
    error = farthest(restitution, 50, 'squeezed_e'//e)
    call check_value('squeezed_lower_e'//e, 1.0e9_wp*error(1), 0.0_wp)
    call check_value('squeezed_upper_e'//e, 1.0e9_wp*error(2), 0.0_wp)
  end subroutine squeeze

  !> The order in dt, from 100 and 200 steps in a collision.
  subroutine order(name, restitution)
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: restitution  !< [-]

    associate (coarse => farthest(restitution, 100, ''), fine => farthest(restitution, 200, ''))
      call check_value(name, log(norm2(coarse)/norm2(fine))/log(2.0_wp), 2.0_wp)
    end associate
  end subroutine order

  !> The largest distance of each ball from its exact height in a millisecond [m].
  function farthest(restitution, steps_per_collision, curve) result(error)
    real(wp), intent(in) :: restitution         !< [-]
    integer, intent(in) :: steps_per_collision
    character(len=*), intent(in) :: curve       !< its name; empty: none
    real(wp) :: error(2)

    integer, parameter :: finer = 20
    type(solids_t) :: solids
    type(contact_settings_t) :: contact
    real(wp) :: x(3, 2), exact(4), dt
    real(wp), parameter :: still(3, 2) = 0.0_wp
    integer :: step, fine

    contact%stiffness = stiffness
    contact%restitution = restitution
    x = gap
    x(3, :) = start
    solids = scene(comm, [2*gap, 2*gap, gap], -gravity, contact)
    call put(solids, x, still, [2*radius, 2*radius], density=density)
    exact = [start, 0.0_wp, 0.0_wp]
    solids%numerics%steps_per_collision = steps_per_collision
    dt = solids%time_step_limit()
    error = 0
    do step = 1, int(end_time/dt)
      call run(solids, 1, dt)
      do fine = 1, finer
        call runge_kutta(restitution, dt/finer, exact)
      end do
      error = max(error, abs(heights(solids) - exact(1:2)))
      if (len(curve) == 0) cycle
      associate (z => heights(solids))
        call point(curve, 1000*solids%time, 1.0e6_wp*(z(2) - start(2)), 1.0e6_wp*(exact(2) - start(2)))
      end associate
    end do
  end function farthest

  !> Of the lower and the upper ball [m].
  pure function heights(solids) result(z)
    type(solids_t), intent(in) :: solids
    real(wp) :: z(2)

    z = solids%parcels%state(3, 1:2)
    if (solids%parcels%id(1) == 2) z = z([2, 1])
  end function heights

  !> Heights' and velocities' rates of change. All three contacts are closed throughout.
  pure function rate(restitution, y) result(slope)
    real(wp), intent(in) :: restitution
    real(wp), intent(in) :: y(4)  !< heights [m], velocities [m/s]
    real(wp) :: slope(4)

    real(wp) :: floor, between, ceiling, per_root

    per_root = 2*sqrt(stiffness)*damping_ratio(restitution)
    floor = stiffness*(radius - y(1)) - per_root*sqrt(mass(1))*y(3)
    between = stiffness*(2*radius - y(2) + y(1)) + per_root*sqrt(product(mass)/sum(mass))*(y(3) - y(4))
    ceiling = stiffness*(y(2) + radius - gap) + per_root*sqrt(mass(2))*y(4)
    slope = [y(3), y(4), (floor - between)/mass(1) - gravity, (between - ceiling)/mass(2) - gravity]
  end function rate

  pure subroutine runge_kutta(restitution, dt, y)
    real(wp), intent(in) :: restitution, dt  !< [-], [s]
    real(wp), intent(inout) :: y(4)

    real(wp) :: a(4), b(4), c(4), d(4)

    a = rate(restitution, y)
    b = rate(restitution, y + dt/2*a)
    c = rate(restitution, y + dt/2*b)
    d = rate(restitution, y + dt*c)
    y = y + dt/6*(a + 2*b + 2*c + d)
  end subroutine runge_kutta

end program verify_squeezed
