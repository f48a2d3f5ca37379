!> Balls that attract each other: scenes, and closed formulas of what parts them.
module sticky_balls
  use chamber, only: chamber_t
  use communicator, only: communicator_t
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put
  use des_settings, only: des_settings_t
  use kinds, only: wp
  use solids, only: solids_t
  implicit none
  private
  public :: r, m, k, a, near, far, sticky, sticky_by_area, modulus, with_ball, two_balls, gap, parting, well, sticking_speed

  ! Balls of 0.1 mm and 1.3e-9 kg: touching ones attract each other with three times their weight.
  real(wp), parameter :: r = 50.0e-6_wp, m = 2500*4*pi/3*r**3, k = 1.0_wp
  real(wp), parameter :: a = 1.0e-18_wp, near = 1.0e-8_wp, far = 1.0e-6_wp

contains

  pure function sticky(restitution) result(contact)
    real(wp), intent(in) :: restitution
    type(contact_settings_t) :: contact

    contact%stiffness = k
    contact%restitution = restitution
    contact%cohesion = 'van_der_waals'
    contact%hamaker_constant = a
    contact%minimum_separation = near
    contact%maximum_separation = far
  end function sticky

  !> Hertz with attraction by area.
  pure function sticky_by_area(restitution) result(contact)
    real(wp), intent(in) :: restitution
    type(contact_settings_t) :: contact

    contact%law = 'hertz'
    contact%youngs_modulus = 1.0e6_wp
    contact%poisson_ratio = 0.25_wp
    contact%impact_velocity = 0.01_wp
    contact%restitution = restitution
    contact%cohesion = 'linear'
    contact%cohesion_energy = 0.03_wp*modulus(contact)
  end function sticky_by_area

  pure function modulus(contact)
    type(contact_settings_t), intent(in) :: contact
    real(wp) :: modulus

    modulus = contact%youngs_modulus/(2*(1 - contact%poisson_ratio**2))
  end function modulus

  !> A box with a ball in it, x from the middle of the box, gravity along z.
  function with_ball(comm, contact, gravity, x, v) result(solids)
    type(communicator_t), intent(in) :: comm
    type(contact_settings_t), intent(in) :: contact
    real(wp), intent(in) :: gravity, x(3), v(3)  !< [m/s2], [m], [m/s]
    type(solids_t) :: solids

    type(chamber_t) :: chamber
    real(wp) :: place(3, 1), velocity(3, 1)

    chamber%lower = 0.0_wp
    chamber%upper = 1.0e-3_wp
    chamber%gravity = [0.0_wp, 0.0_wp, gravity]
    call solids%create(comm, chamber, contact, des_settings_t(), .false., 0.0_wp)
    place(:, 1) = 0.5e-3_wp + x
    velocity(:, 1) = v
    call put(solids, place, velocity, [2*r])
  end function with_ball

  !> Two balls with a gap between them that move apart.
  function two_balls(comm, contact, gap, speed) result(solids)
    type(communicator_t), intent(in) :: comm
    type(contact_settings_t), intent(in) :: contact
    real(wp), intent(in) :: gap, speed  !< [m], of one from the other [m/s]
    type(solids_t) :: solids

    real(wp) :: x(3, 2), v(3, 2)

    solids = scene(comm, [1.0e-3_wp, 1.0e-3_wp, 1.0e-3_wp], 0.0_wp, contact)
    x = 0.5e-3_wp
    x(1, 2) = x(1, 1) + 2*r + gap
    v = 0.0_wp
    v(1, :) = [-0.5_wp, 0.5_wp]*speed
    call put(solids, x, v, [2*r, 2*r])
  end function two_balls

  !> Of two balls, or of one and the floor [m].
  pure function gap(solids)
    type(solids_t), intent(in) :: solids
    real(wp) :: gap

    associate (s => solids%parcels%state)
      if (solids%parcels%n == 1) gap = s(3, 1) - s(4, 1)
      if (solids%parcels%n == 2) gap = norm2(s(1:3, 1) - s(1:3, 2)) - s(4, 1) - s(4, 2)
    end associate
  end function gap

  !> Speed with which they part [m/s].
  pure function parting(solids) result(speed)
    type(solids_t), intent(in) :: solids
    real(wp) :: speed

    associate (s => solids%parcels%state)
      if (solids%parcels%n == 1) speed = s(7, 1)
      if (solids%parcels%n == 2) speed = dot_product(s(5:7, 1) - s(5:7, 2), s(1:3, 1) - s(1:3, 2))/norm2(s(1:3, 1) - s(1:3, 2))
    end associate
  end function parting

  !> Energy it takes to part surfaces at rest on a spring without damping, R width of the pair:
  !> F^2/(2 k) + F h_min + A R/6 (1/h_min - 1/h_max), F = A R/(6 h_min^2).
  pure function well(width) result(energy)
    real(wp), intent(in) :: width
    real(wp) :: energy(2)  !< in contact, and outside [J]

    real(wp) :: f

    f = a*width/(6*near**2)
    energy = [f**2/(2*k), f*near + a*width/6*(1/near - 1/far)]
  end function well

  !> Speed below which two balls from afar stay together [m/s]: the one with which they leave the contact with just the
  !> energy of the attraction outside, after a damped swing under its constant force.
  pure function sticking_speed(restitution) result(critical)
    real(wp), intent(in) :: restitution
    real(wp) :: critical

    real(wp) :: energy(2), square, low, high
    integer :: i

    energy = well(r/2)
    square = 2*energy(2)/(m/2)
    low = 0
    high = 1.0_wp
    do i = 1, 60
      critical = (low + high)/2
      if (left_with(sqrt(critical**2 + square), restitution)**2 < square) then
        low = critical
      else
        high = critical
      end if
    end do
  end function sticking_speed

  !> Speed with which the overlap of two balls that began with `speed` ends; 0 if it never does.
  pure function left_with(speed, restitution) result(after)
    real(wp), intent(in) :: speed, restitution
    real(wp) :: after

    real(wp) :: zeta, omega, damped, rest, b, t, step, delta
    integer :: i

    zeta = -log(restitution)/sqrt(pi**2 + log(restitution)**2)
    omega = sqrt(k/(m/2))
    damped = omega*sqrt(1 - zeta**2)
    rest = a*(r/2)/(6*near**2)/k
    b = (speed - zeta*omega*rest)/damped
    step = 1.0e-4_wp/omega
    after = 0
    do i = 1, 100000
      t = i*step
      delta = rest + exp(-zeta*omega*t)*(b*sin(damped*t) - rest*cos(damped*t))
      if (delta > 0) cycle
      after = -exp(-zeta*omega*t)*(damped*(b*cos(damped*t) + rest*sin(damped*t)) &
                                   - zeta*omega*(b*sin(damped*t) - rest*cos(damped*t)))
      return
    end do
  end function left_with

end module sticky_balls
