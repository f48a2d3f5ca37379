!> How real particles answer the drag of a gas over one gas step, whatever its length.
!>
!> A particle of mass m and diameter d at velocity v, in gas of velocity u and void fraction eps, obeys
!>
!>   m dv/dt = m a + beta (u - v)/eps,    beta = 3 pi mu d eps F(Re, eps),    Re = rho eps |u - v| d/mu.
!>
!> Drag is beta (u - v). Gas that is forced past particles pays for drag with a pressure gradient, which pushes the same
!> particles by phi/eps times the drag: together they are drag over eps. a is the acceleration by all the rest. For
!> constant a, beta and gas velocity u' the solution over a step dt, with tau = eps m/beta, has the mean drag
!>
!>   D = beta_eff (u' - v_hat),    beta_eff = eps m r/dt,    v_hat = v + q dt a,
!>   r = 1 - exp(-dt/tau),         q = 1/r - tau/dt.                                                          (1)
!>
!> u' is the gas velocity at the end of the step. The gas gets beta_eff and beta_eff v_hat, so that its equation is
!> implicit in u' and knows how the particles give way; then the particles get D and the pressure gradient of that gas,
!> constant over the step. a is taken from the last step, as all that changed the velocity then beside D/eps: contacts,
!> and what the pressure gradient was beside that of drag; in a particle's first step it is g - grad p/rho_p. beta
!> belongs to the slip w = u - v in the middle of the step, predicted with the beta of the slip at its start:
!>
!>   w_middle = w - r (w + tau a)/2.                                                                           (2)
!>
!> So the velocity of a particle in a given gas is second order in dt. A 100 um grain that starts at rest keeps within
!> 4e-6 of its final speed of the exact path at dt = tau/50; with the slip of the start for beta it would be 6e-4, with
!> the linearly implicit beta_eff = beta/(1 + dt/tau), v_hat = v + a dt it would be 3e-3.
!>
!> Stability for dt far above tau:
!>
!> - A particle without contacts has v' = v + r (u' + tau a - v): monotone for a given tau, and settled exactly at
!>   u' + tau a.
!> - Contacts answer drag, and a knows of it one step late. Let them undo a share s of it: with X = dt D/m then
!>   a dt = -s X, v' = v + (1 - s) X and X' = r (u - v' + s q X), a linear map with the trace 1 + r (s + s q - 1) and
!>   the determinant r q s. As r q = 1 - r tau/dt lies below 1, so do both roots in modulus for every s < 1
!>   (determinant < 1, |trace| < 1 + determinant), at any dt/tau. A particle held fast, s = 1, has
!>   X' = r (u - v) + r q X, which converges to the full drag D = beta (u - v).
!> - So does what the pressure gradient is beside phi/eps D: where gas and particles move freely together in a periodic
!>   box there is none, s = phi. With tau = m/beta and all of the gradient in a, s were -phi/eps, and the slip of a bed with
!>   eps < 3/4 that no contact holds would swing ever wider for dt >> tau.
!> - Gas and particles that share a cell, M times its mass, exchange (1): u' = (u + M r v)/(1 + M r), a mean of u and
!>   v with positive weights, as is v' = (1 - r) v + r u'. Neither can ring.
!> - beta after (2) is exact where F does not depend on the slip. Where F grows like a power p of it, dt >> tau
!>   multiplies an error of the slip by -p (1 - p)/2 per step, by 0.4 at most: p is 1.54 or less, of all laws. With the
!>   slip of the start it would be -p, and a fast coarse grain (p = 1) would swing between two slips for ever.
!>
!> With a gas that changes within the step (1) is first order. Where gas and particles accelerate together by c, their
!> slip is tau (a - c) for dt << tau, but tau a for dt >> tau: of the order of the terminal velocity, wrong by c/a.
module drag_response
  use constants, only: pi
  use coupling_settings, only: coupling_settings_t
  use drag_law, only: drag_law_t, new_drag_law
  use kinds, only: wp
  use sizes_beetstra, only: among_sizes_beetstra
  use sizes_cello, only: among_sizes_cello
  use sizes_yin_sundaresan, only: among_sizes_yin_sundaresan
  use text, only: word_length
  implicit none
  private
  public :: drag_t, particles_t, new_drag, shares, block

  integer, parameter :: block = 64  !< particles treated together: their values fit in the first cache

  real(wp), parameter :: slowest = 1.0e-30_wp  !< least 1/tau, of a particle that feels no drag at all [1/s]

  !> A drag law in a gas.
  type :: drag_t
    private
    type(drag_law_t) :: law
    character(len=word_length) :: polydispersity  !< 'none', or by which law sizes matter
    logical, public :: density_varies  !< whether each particle meets a density of its own
    real(wp) :: density    !< if not [kg/m3]
    real(wp) :: viscosity  !< dynamic [Pa s]
  contains
    procedure :: respond
  end type drag_t

  !> Some real particles, what they meet and how they answer.
  type :: particles_t
    integer :: n = 0                        !< of at most `block`
    real(wp) :: diameter(block)             !< d [m]
    real(wp) :: inverse_mass(block)         !< 1/m [1/kg]
    real(wp) :: eps(block)                  !< void fraction [-]
    real(wp) :: density(block)              !< of the gas, if it varies [kg/m3]
    real(wp) :: slip(3, block)              !< u - v at the start of the step [m/s]
    real(wp) :: acceleration(3, block)      !< a, by all but drag and its pressure gradient [m/s2]
    real(wp) :: mean_diameter(block)        !< of the particles around, <d>, with polydispersity only [m]
    real(wp) :: spread(block)               !< S of local_sizes, with polydispersity only [-]
    real(wp) :: coefficient(block)          !< answer: beta_eff [kg/s]
    real(wp) :: lead(3, block)              !< answer: v_hat - v [m/s]
  end type particles_t

contains

  function new_drag(settings, density, viscosity, density_varies) result(drag)
    type(coupling_settings_t), intent(in) :: settings
    real(wp), intent(in) :: density         !< of the gas [kg/m3]
    real(wp), intent(in) :: viscosity       !< dynamic [Pa s]
    logical, intent(in), optional :: density_varies  !< each particle brings its own instead; not unless given
    type(drag_t) :: drag

    drag%law = new_drag_law(trim(settings%drag), settings%syamlal_c1, settings%syamlal_d1)
    drag%polydispersity = settings%polydispersity
    drag%density_varies = .false.
    if (present(density_varies)) drag%density_varies = density_varies
    drag%density = density
    drag%viscosity = viscosity
  end function new_drag

  !> beta_eff and v_hat of equation (1).
  pure subroutine respond(self, dt, particles)
    class(drag_t), intent(in) :: self
    real(wp), intent(in) :: dt  !< [s]
    type(particles_t), intent(inout) :: particles

    integer :: i
    real(wp) :: rate(particles%n), middle(3, particles%n), r, q

    associate (n => particles%n, slip => particles%slip, a => particles%acceleration)
      rate = relaxation_rates(self, particles, slip)
      do i = 1, n
        call shares(dt*rate(i), r, q)
        middle(:, i) = slip(:, i) - 0.5_wp*r*(slip(:, i) + a(:, i)/rate(i))
      end do
      rate = relaxation_rates(self, particles, middle)
      do i = 1, n
        call shares(dt*rate(i), r, q)
        particles%coefficient(i) = particles%eps(i)*r/(dt*particles%inverse_mass(i))
        particles%lead(:, i) = q*dt*a(:, i)
      end do
    end associate
  end subroutine respond

  !> 1/tau of each particle at the given slip [1/s]. One law per sweep.
  pure function relaxation_rates(self, particles, slip) result(rate)
    class(drag_t), intent(in) :: self
    type(particles_t), intent(in) :: particles
    real(wp), intent(in) :: slip(:,:)  !< (3, n or more) [m/s]
    real(wp) :: rate(particles%n)

    real(wp) :: factor(particles%n)

    associate (n => particles%n, d => particles%diameter, eps => particles%eps)
      if (self%polydispersity == 'none') then
        call self%law%find_factors(reynolds_numbers(self, d, particles, slip), eps(:n), factor)
      else
        call self%law%find_factors(reynolds_numbers(self, particles%mean_diameter, particles, slip), eps(:n), factor)
        call mind_sizes(self, particles, factor)
      end if
      rate = max(slowest, 3.0_wp*pi*self%viscosity*d(:n)*factor*particles%inverse_mass(:n))
    end associate
  end function relaxation_rates

  pure function reynolds_numbers(self, diameter, particles, slip) result(reynolds)
    class(drag_t), intent(in) :: self
    real(wp), intent(in) :: diameter(:)  !< (n or more) their own, or the mean around them [m]
    type(particles_t), intent(in) :: particles
    real(wp), intent(in) :: slip(:,:)    !< (3, n or more) [m/s]
    real(wp) :: reynolds(particles%n)

    integer :: i

    if (self%density_varies) then
      do i = 1, particles%n
        reynolds(i) = particles%density(i)/self%viscosity*particles%eps(i)*diameter(i) &
          *sqrt(slip(1, i)**2 + slip(2, i)**2 + slip(3, i)**2)
      end do
      return
    end if
    do i = 1, particles%n
      reynolds(i) = self%density/self%viscosity*particles%eps(i)*diameter(i) &
        *sqrt(slip(1, i)**2 + slip(2, i)**2 + slip(3, i)**2)
    end do
  end function reynolds_numbers

  !> From F of particles of the mean size to those of each size.
  pure subroutine mind_sizes(self, particles, factor)
    class(drag_t), intent(in) :: self
    type(particles_t), intent(in) :: particles
    real(wp), intent(inout) :: factor(:)  !< (n) [-]

    real(wp) :: y(particles%n)

    associate (n => particles%n)
      y = particles%diameter(:n)/particles%mean_diameter(:n)
      select case (self%polydispersity)
      case ('beetstra')
        factor = among_sizes_beetstra(factor, y)
      case ('yin_sundaresan')
        factor = among_sizes_yin_sundaresan(factor, particles%eps(:n), y)
      case default
        factor = among_sizes_cello(factor, particles%eps(:n), y, particles%spread(:n))
      end select
    end associate
  end subroutine mind_sizes

  !> r = 1 - exp(-x) and q = 1/r - 1/x, without cancellation at small x.
  pure subroutine shares(x, r, q)
    real(wp), intent(in) :: x  !< dt/tau [-]
    real(wp), intent(out) :: r, q

    if (x > 0.1_wp) then
      r = 1.0_wp - exp(-x)
      q = 1.0_wp/r - 1.0_wp/x
    else
      ! the series of x/(1 - exp(-x)), its first two terms apart
      q = 0.5_wp + x/12.0_wp*(1.0_wp - x**2/60.0_wp*(1.0_wp - x**2/42.0_wp*(1.0_wp - x**2/40.0_wp)))
      r = x/(1.0_wp + q*x)
    end if
  end subroutine shares

end module drag_response
