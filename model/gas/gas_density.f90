!> What a density that follows the pressure changes in the equations of the gas,
!>
!>   rho = psi (p_ref + p),    psi = M/(R T),
!>
!> an ideal gas of one temperature. The rest of the gas works with the constant density
!> rho_0 = psi (p_ref + pressure of &gas); what rho is beside it is added here.
!>
!> Continuity: a cell stores V (eps rho - eps_old rho_old)/dt. The density of a face lies on the straight line between those of
!> its two cells; on the surface of the domain it is that of the pressure given there, or else of the cell. A correction p' of
!> the pressure changes the flow through a face, G = rho a u, by
!>
!>   G' = -rho a d (p'_above - p'_below) + a u psi p'_face.
!>
!> The second part would make the matrix unsymmetric. But where drag rules u = -d (p_above - p_below), and then, as all means on
!> a face are arithmetic on equal cells, G' = -a d ((rho p')_above - (rho p')_below) exactly. So the unknown is y = rho p',
!>
!>   sum over faces of a d (y - y_beyond) + eps V psi/(dt rho) y = -imbalance,
!>
!> a symmetric M-matrix. What is left to the next iteration is a (u + d (p_above - p_below)) psi p'_face, the flow that
!> pressure does not drive. With w for that velocity, c = psi^(-1/2) the speed of sound, p' = exp(i k x), s = sin(k h/2) and
!> without drag d = dt/(rho h), it is to what the matrix has as 2 s psi w to 4 s^2 dt/h + h psi/dt, whose least value is
!> 4 s psi^(1/2): iterations leave at most half of the Mach number w/c of it, whatever the step. An isothermal gas carries no
!> density along with its flow, only sound does, hence nothing is upwind.
!>
!> Momentum: the conservative equation less u times continuity, as in `momentum`, with the inertia eps_old rho_old V/dt and
!> the weight of the density at hand.
module gas_density
  use boundary_settings, only: boundary_settings_t
  use constants, only: is_set
  use gas_settings, only: gas_settings_t, compressibility
  use gas_state, only: gas_state_t, find_density, set_vents, vents
  use kinds, only: wp
  use mesh, only: unit_step
  implicit none
  private
  public :: let_vary, balance, begin_density, follow_pressure, add_inertia, add_weight, pressed_flow, heed_round_off

contains

  !> Make the gas an ideal one.
  subroutine let_vary(state, settings, records)
    class(gas_state_t), intent(inout) :: state
    type(gas_settings_t), intent(in) :: settings
    type(boundary_settings_t), intent(in) :: records(:)

    integer :: m

    allocate (state%ideal)
    associate (ideal => state%ideal, n => state%boxes%n)
      ideal%compressibility = compressibility(settings)
      ideal%reference = settings%reference_pressure
      allocate (ideal%by_mass(0:size(records)), source=.false.)
      ideal%by_mass(1:) = [(is_set(records(m)%mass_flow), m=1, size(records))]
      allocate (ideal%density, ideal%old, source=state%pressure)
      allocate (ideal%face, source=state%velocity)
      allocate (ideal%capacity(n(1), n(2), n(3)), source=0.0_wp)
      ideal%face = state%density
    end associate
    call find_density(state)
  end subroutine let_vary

  !> The pressure of a gas at rest under gravity, before the first step: that of &gas at the mean height of the open faces, or
  !> in the middle of a closed domain, and (p_ref + p) ~ exp(psi g.x). Periodic directions have no weight of their own.
  subroutine balance(state)
    class(gas_state_t), intent(inout) :: state

    real(wp) :: gravity(3), level, x(3)
    integer :: i, j, k

    gravity = merge(0.0_wp, state%gravity, state%mesh%periodic)
    if (.not. any(abs(gravity) > 0.0_wp)) return
    level = open_level(state, gravity)
    associate (ideal => state%ideal, lo => state%boxes%lo, mesh => state%mesh)
      do k = 1, state%boxes%n(3)
        do j = 1, state%boxes%n(2)
          do i = 1, state%boxes%n(1)
            x = mesh%in_metres(lo + [i, j, k] - 1.5_wp)
            state%pressure(i, j, k) = (ideal%reference + state%pressure(i, j, k)) &
              *exp(ideal%compressibility*(dot_product(gravity, x) - level)) - ideal%reference
          end do
        end do
      end do
    end associate
    call state%halo%exchange(state%pressure)
    call set_vents(state)
    call find_density(state)
  end subroutine balance

  !> Mean of g.x over the open faces and walls of all ranks; in a closed domain its value in the middle [m2/s2].
  function open_level(state, gravity) result(level)
    class(gas_state_t), intent(in) :: state
    real(wp), intent(in) :: gravity(3)
    real(wp) :: level

    real(wp) :: sums(2), x(3)
    integer :: a, end, i, j, k, lo(3), hi(3)

    sums = 0.0_wp
    do a = 1, 3
      do end = 1, 2
        if (.not. state%boundary%side(end, a)%mine) cycle
        lo = 1
        hi = state%boxes%n
        lo(a) = merge(0, hi(a), end == 1)
        hi(a) = lo(a)
        do k = lo(3), hi(3)
          do j = lo(2), hi(2)
            do i = lo(1), hi(1)
              if (.not. state%free(i, j, k, a) > 0.0_wp) cycle
              x = state%mesh%in_metres(state%boxes%lo + [i, j, k] - 1.5_wp + 0.5_wp*unit_step(a))
              sums = sums + [dot_product(gravity, x), 1.0_wp]
            end do
          end do
        end do
      end do
    end do
    if (vents(state)) call add_vents(state, gravity, sums)
    sums = state%boxes%comm%sum(sums)
    level = 0.5_wp*dot_product(gravity, state%mesh%lower + state%mesh%upper)
    if (sums(2) > 0.0_wp) level = sums(1)/sums(2)
  end function open_level

  !> The cells whose walls are outflows.
  pure subroutine add_vents(state, gravity, sums)
    class(gas_state_t), intent(in) :: state
    real(wp), intent(in) :: gravity(3)
    real(wp), intent(inout) :: sums(2)

    integer :: i, j, k

    do k = 1, state%boxes%n(3)
      do j = 1, state%boxes%n(2)
        do i = 1, state%boxes%n(1)
          if (.not. state%boundary%walls%vents(i, j, k)) cycle
          sums = sums + [dot_product(gravity, state%mesh%in_metres(state%boxes%lo + [i, j, k] - 1.5_wp)), 1.0_wp]
        end do
      end do
    end do
  end subroutine add_vents

  !> The density at the start of a step; after the passages and the given velocities.
  subroutine begin_density(state, dt)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(in) :: dt  !< [s]

    call find_density(state)
    associate (ideal => state%ideal, n => state%boxes%n)
      ideal%old = ideal%density
      ideal%dt = dt
      ideal%capacity = ideal%compressibility/dt*state%volume(1:n(1), 1:n(2), 1:n(3))*state%eps(1:n(1), 1:n(2), 1:n(3)) &
        /ideal%density(1:n(1), 1:n(2), 1:n(3))
    end associate
    call follow_pressure(state)
  end subroutine begin_density

  !> The densities that belong to the pressure at hand, what cells store then, and the velocities of given mass flows.
  subroutine follow_pressure(state)
    class(gas_state_t), intent(inout) :: state

    integer :: a, end

    call find_density(state)
    associate (n => state%boxes%n, rho => state%ideal%density)
      state%ideal%least = state%boxes%comm%min(minval(rho(1:n(1), 1:n(2), 1:n(3))))
    end associate
    do a = 1, 3
      call find_faces(state, a)
      do end = 1, 2
        if (.not. state%boundary%side(end, a)%mine) cycle
        call find_surface(state, a, end)
        if (any(state%ideal%by_mass)) call keep_mass_flow(state, a, end)
      end do
    end do
    associate (ideal => state%ideal, n => state%boxes%n)
      ! V (eps rho - eps_old rho_old)/dt, exact also where the pressure changes by little of what it is
      state%storage = state%volume(1:n(1), 1:n(2), 1:n(3))/ideal%dt &
        *(state%eps(1:n(1), 1:n(2), 1:n(3))*ideal%compressibility &
            *(state%pressure(1:n(1), 1:n(2), 1:n(3)) - state%pressure_before(1:n(1), 1:n(2), 1:n(3))) &
          + (state%eps(1:n(1), 1:n(2), 1:n(3)) - state%eps_old(1:n(1), 1:n(2), 1:n(3)))*ideal%old(1:n(1), 1:n(2), 1:n(3)))
      if (allocated(state%seep)) state%storage = state%storage - state%seep(1:n(1), 1:n(2), 1:n(3))
    end associate
  end subroutine follow_pressure

  !> On the straight line between the densities of the two cells.
  subroutine find_faces(state, a)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a

    integer :: i, j, k, m, e(3)
    real(wp) :: nearer

    e = unit_step(a)
    associate (n => state%boxes%n, rho => state%ideal%density, width => state%spacing(a)%width)
      do k = -1, n(3) + 1
        do j = -1, n(2) + 1
          do i = -1, n(1) + 1
            m = dot_product(e, [i, j, k])
            nearer = width(m + 1)/(width(m) + width(m + 1))
            state%ideal%face(i, j, k, a) = nearer*rho(i, j, k) + (1 - nearer)*rho(i + e(1), j + e(2), k + e(3))
          end do
        end do
      end do
    end associate
  end subroutine find_faces

  !> On one side of the domain: of the pressure given there, which the cell beyond holds, or of the cell inside.
  subroutine find_surface(state, a, end)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a, end

    integer :: i, j, k, lo(3), hi(3), inner(3), outer(3)

    call side_with_rim(state, a, end, lo, hi)
    inner = merge(unit_step(a), 0, end == 1)
    outer = merge(unit_step(a), 0, end == 2)
    associate (open => state%boundary%side(end, a)%open, rho => state%ideal%density)
      do k = lo(3), hi(3)
        do j = lo(2), hi(2)
          do i = lo(1), hi(1)
            state%ideal%face(i, j, k, a) = merge(rho(i + outer(1), j + outer(2), k + outer(3)), &
                                                 rho(i + inner(1), j + inner(2), k + inner(3)), open(i, j, k))
          end do
        end do
      end do
    end associate
  end subroutine find_surface

  !> Where a mass flow is given the velocity is what it makes at the density of the face; its row in the matrix is told.
  subroutine keep_mass_flow(state, a, end)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a, end

    integer :: i, j, k, lo(3), hi(3), inner(3)
    real(wp) :: inward

    call side_with_rim(state, a, end, lo, hi)
    inner = merge(unit_step(a), 0, end == 1)
    inward = merge(1.0_wp, -1.0_wp, end == 1)
    associate (side => state%boundary%side(end, a), ideal => state%ideal)
      do k = lo(3), hi(3)
        do j = lo(2), hi(2)
          do i = lo(1), hi(1)
            if (.not. ideal%by_mass(side%record(i, j, k))) cycle
            if (state%passage(i, j, k, a) <= 0.0_wp) cycle  ! the rim beyond the domain
            state%velocity(i, j, k, a) = inward*side%flow(i, j, k)*state%density &
              /(ideal%face(i, j, k, a)*state%eps(i + inner(1), j + inner(2), k + inner(3)))
            state%source(i, j, k, a) = state%fixed(i, j, k, a)*state%velocity(i, j, k, a)
          end do
        end do
      end do
    end associate
  end subroutine keep_mass_flow

  !> The faces of one side of the domain, and one beyond its edges.
  pure subroutine side_with_rim(state, a, end, lo, hi)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a, end
    integer, intent(out) :: lo(3), hi(3)

    lo = 0
    hi = state%boxes%n + 1
    lo(a) = merge(0, state%boxes%n(a), end == 1)
    hi(a) = lo(a)
  end subroutine side_with_rim

  !> Add to `fixed` and `source` of component a the inertia of what the old density is beside rho_0.
  subroutine add_inertia(state, a)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a

    integer :: i, j, k, e(3), x, y, z
    real(wp) :: inertia

    e = unit_step(a)
    associate (first => state%first(:, a), n => state%boxes%n, volume => state%volume, eps => state%eps_old, &
               old => state%ideal%old, rho_0 => state%density, dt => state%ideal%dt)
      do k = first(3), n(3)
        z = k + e(3)
        do j = first(2), n(2)
          y = j + e(2)
          do i = first(1), n(1)
            x = i + e(1)
            inertia = state%free(i, j, k, a)*0.5_wp/dt*(volume(i, j, k)*eps(i, j, k)*(old(i, j, k) - rho_0) &
                                                        + volume(x, y, z)*eps(x, y, z)*(old(x, y, z) - rho_0))
            state%fixed(i, j, k, a) = state%fixed(i, j, k, a) + inertia
            state%source(i, j, k, a) = state%source(i, j, k, a) + inertia*state%velocity_before(i, j, k, a)
          end do
        end do
      end do
    end associate
  end subroutine add_inertia

  !> Add to the right-hand side of component a the weight of what the density is beside rho_0. It acts on the passage times the
  !> distance of the pressures beside it, so that a gas at rest stays so.
  subroutine add_weight(state, a)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a

    integer :: i, j, k, e(3), x, y, z, m
    real(wp) :: reach, excess

    if (.not. abs(state%gravity(a)) > 0.0_wp) return
    e = unit_step(a)
    associate (s => state%stencil(a), eps => state%eps, rho => state%ideal%density, width => state%spacing(a)%width)
      do k = s%lo(3), s%n(3)
        z = k + e(3)
        do j = s%lo(2), s%n(2)
          y = j + e(2)
          do i = s%lo(1), s%n(1)
            x = i + e(1)
            m = dot_product(e, [i, j, k])
            reach = 0.5_wp*(merge(width(m), 0.0_wp, eps(i, j, k) > 0.0_wp) + merge(width(m + 1), 0.0_wp, eps(x, y, z) > 0.0_wp))
            excess = 0.5_wp*(rho(i, j, k) + rho(x, y, z)) - state%density
            s%rhs(i, j, k) = s%rhs(i, j, k) + state%free(i, j, k, a)*state%gravity(a)*state%passage(i, j, k, a)*reach*excess
          end do
        end do
      end do
    end associate
  end subroutine add_weight

  !> What the pressures at hand would set in motion along each direction in one step if nothing else did, the mean over the
  !> planes across it and over all ranks [kg/s].
  function pressed_flow(state) result(flow)
    class(gas_state_t), intent(in) :: state
    real(wp) :: flow(3)

    integer :: a, i, j, k, e(3)

    flow = 0.0_wp
    do a = 1, 3
      if (.not. state%stencil(a)%active) cycle
      e = unit_step(a)
      associate (first => state%first(:, a), n => state%boxes%n, p => state%pressure)
        do k = first(3), n(3)
          do j = first(2), n(2)
            do i = first(1), n(1)
              flow(a) = flow(a) + state%ideal%face(i, j, k, a)*state%passage(i, j, k, a)*state%mobility(i, j, k, a) &
                *abs(p(i + e(1), j + e(2), k + e(3)) - p(i, j, k))
            end do
          end do
        end do
      end associate
    end do
    flow = state%boxes%comm%sum(flow)/state%mesh%n
  end function pressed_flow

  !> Ask of a step no more than the last bit of the pressure allows: where hardly anything moves that is more than the
  !> tolerances of nothing.
  subroutine heed_round_off(state, force_scale)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(inout) :: force_scale  !< [N]

    real(wp) :: bit, sums(2)

    associate (n => state%boxes%n, ideal => state%ideal, numerics => state%numerics)
      associate (rho => ideal%density(1:n(1), 1:n(2), 1:n(3)), passage => state%passage(1:n(1), 1:n(2), 1:n(3), :))
        bit = spacing(state%boxes%comm%max(maxval(abs(state%pressure(1:n(1), 1:n(2), 1:n(3))))))
        sums = bit*state%boxes%comm%sum([sum(passage), sum(rho*ideal%capacity)])
      end associate
      force_scale = max(force_scale, sums(1)/numerics%velocity_tolerance)
      state%report%mass_scale = max(state%report%mass_scale, sums(2)/numerics%tolerance)
    end associate
  end subroutine heed_round_off

end module gas_density
