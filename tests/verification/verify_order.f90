!> The order in dt of a head-on collision of two unequal parcels.
program verify_order
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use check, only: finish
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, place_of, run
  use kinds, only: wp
  use report, only: check_value, point
  use solids, only: solids_t
  use spring_contact, only: spring_contact_t, new_spring_contact
  implicit none

  real(wp), parameter :: radius(2) = [0.5e-3_wp, 0.8e-3_wp], density = 2500.0_wp, stiffness = 300.0_wp, speed = 0.2_wp
  real(wp), parameter :: mass(2) = density*4*pi/3*radius**3
  integer, parameter :: steps(5) = [20, 40, 80, 160, 320]  !< in a collision
  type(communicator_t) :: comm

  call start_ranks(comm)
  call order('order_elastic', 1.0_wp, 4)
  call order('order_damped', 0.6_wp, 2)
  call finish()
  call stop_ranks()

contains

  !> The slope of the logarithm of the error over that of dt, between the two shortest steps.
  subroutine order(name, restitution, expected)
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: restitution  !< [-]
    integer, intent(in) :: expected

    real(wp) :: error(size(steps))
    integer :: k

    do k = 1, size(steps)
      error(k) = collision_error(restitution, steps(k))
      call point(name, 1/real(steps(k), wp), error(k), error(1)*(real(steps(1), wp)/steps(k))**expected)
    end do
    k = size(steps)
    call check_value(name, log(error(k)/error(k - 1))/log(real(steps(k - 1), wp)/steps(k)), real(expected, wp))
  end subroutine order

  !> Distance and relative speed half a collision time after the collision, their errors over the depth v/omega_0 and
  !> the speed v: root of the mean square over where in a step the collision begins.
  function collision_error(restitution, steps_per_collision) result(error)
    real(wp), intent(in) :: restitution         !< [-]
    integer, intent(in) :: steps_per_collision
    real(wp) :: error

    integer, parameter :: starts = 20
    type(spring_contact_t) :: contact
    type(solids_t) :: pair
    type(contact_settings_t) :: settings
    real(wp) :: dt, gap, exact
    real(wp) :: x(3, 2), v(3, 2)
    integer :: m

    contact = new_spring_contact(stiffness, product(mass)/sum(mass), restitution, 0.0_wp)
    dt = contact%collision_time()/steps_per_collision
    settings%stiffness = stiffness
    settings%restitution = restitution
    v = 0.0_wp
    v(1, :) = [mass(2), -mass(1)]/sum(mass)*speed
    error = 0
    do m = 1, starts
      gap = speed*dt*(m - 0.5_wp)/starts
      x = 0.01_wp
      x(1, 2) = x(1, 1) + sum(radius) + gap
      pair = scene(comm, [0.02_wp, 0.02_wp, 0.02_wp], 0.0_wp, settings)
      call put(pair, x, v, 2*radius, density=[density, density])
      call run(pair, steps_per_collision + steps_per_collision/2, dt)
      exact = restitution*speed*(pair%time - gap/speed - contact%collision_time())
      associate (a => pair%parcels%state(:, place_of(pair, 1)), b => pair%parcels%state(:, place_of(pair, 2)))
        error = error + ((b(1) - a(1) - sum(radius) - exact)*contact%omega/speed)**2 &
                + ((b(5) - a(5))/speed - restitution)**2
      end associate
    end do
    error = sqrt(error/starts)
  end function collision_error

end program verify_order
