!> Properties of contacts, by pair of materials.
!>
!> What no &material_pair says follows from the two materials, each with its own properties, those of a contact with its like:
!>
!>   moduli        both, as Hertz's and Mindlin's laws have them: see contact_hertz
!>   stiffness     k = 2 k_i k_j/(k_i + k_j): a contact is two springs in series, of 2 k_i and 2 k_j
!>   restitution   e = sqrt(e_i e_j), so that ln e, to which the damping goes about in proportion, is the mean
!>   friction      mu = sqrt(mu_i mu_j), so that nothing sticks to what is smooth
!>   rolling       mu_r = sqrt(mu_r,i mu_r,j), eta = sqrt(eta_i eta_j), as friction
!>   attraction    A = sqrt(A_i A_j), k = sqrt(k_i k_j)
!>
!> The geometric means of restitution, friction and rolling are those of LAMMPS (pair_style granular, section Mixing). None has a
!> theory; who knows the pair gives it. That of Hamaker's constants across a gas follows from Berthelot's for atoms: Israelachvili,
!> Intermolecular and Surface Forces, section Combining relations. k goes as the work of adhesion, of which the same holds:
!> Girifalco & Good, J. Phys. Chem. 61 (1957) 904-909, with their factor at 1.
!>
!> A material's property that is not given is that of &contact. Material 0 is that of &contact; a wall of material 0 has no
!> properties of its own: it is as the parcel that touches it, where &contact does not say otherwise.
module contact_pairs
  use constants, only: is_set
  use contact_hertz, only: elastic_t
  use contact_settings, only: contact_settings_t
  use kinds, only: wp
  use material_settings, only: material_settings_t
  implicit none
  private
  public :: pair_t, pair_of, wall_pair_of, is_alike, scaled_restitution

  !> What contacts of two materials are like.
  type :: pair_t
    real(wp) :: stiffness                 !< linear: k_n [N/m]
    type(elastic_t) :: one, other         !< hertz: both partners
    real(wp) :: restitution               !< e_n [-]
    real(wp) :: friction                  !< mu [-]
    real(wp) :: tangential_ratio          !< linear: k_t/k_n [-]
    real(wp) :: tangential_damping_ratio  !< gamma_t/gamma_n [-]
    real(wp) :: rolling_friction          !< mu_r [-]
    real(wp) :: rolling_damping           !< eta [-]
    real(wp) :: hamaker_constant          !< [J]
    real(wp) :: cohesion_energy           !< [J/m3]
  end type pair_t

contains

  !> Between parcels of materials a and b, or a parcel and a wall that has a material.
  pure function pair_of(contact, a, b) result(pair)
    type(contact_settings_t), intent(in) :: contact
    integer, intent(in) :: a, b  !< places of the materials, 0: that of &contact
    type(pair_t) :: pair

    type(material_settings_t) :: one, other
    integer :: i

    one = properties(contact, min(a, b))
    other = properties(contact, max(a, b))
    pair%one = elastic_t(one%youngs_modulus, one%poisson_ratio)
    pair%other = elastic_t(other%youngs_modulus, other%poisson_ratio)
    pair%stiffness = springs_in_series(one%stiffness, other%stiffness)
    pair%restitution = geometric_mean(one%restitution, other%restitution)
    pair%friction = geometric_mean(one%friction, other%friction)
    pair%rolling_friction = geometric_mean(one%rolling_friction, other%rolling_friction)
    pair%rolling_damping = geometric_mean(one%rolling_damping, other%rolling_damping)
    pair%hamaker_constant = geometric_mean(one%hamaker_constant, other%hamaker_constant)
    pair%cohesion_energy = geometric_mean(one%cohesion_energy, other%cohesion_energy)
    pair%tangential_ratio = contact%tangential_ratio
    pair%tangential_damping_ratio = contact%tangential_damping_ratio
    if (allocated(contact%pairs)) then
      do i = 1, size(contact%pairs)
        associate (given => contact%pairs(i))
          if (minval(given%materials) /= min(a, b) .or. maxval(given%materials) /= max(a, b)) cycle
          pair%stiffness = first_set(given%stiffness, pair%stiffness)
          pair%restitution = first_set(given%restitution, pair%restitution)
          pair%friction = first_set(given%friction, pair%friction)
          pair%tangential_ratio = first_set(given%tangential_ratio, pair%tangential_ratio)
          pair%tangential_damping_ratio = first_set(given%tangential_damping_ratio, pair%tangential_damping_ratio)
          pair%rolling_friction = first_set(given%rolling_friction, pair%rolling_friction)
          pair%rolling_damping = first_set(given%rolling_damping, pair%rolling_damping)
          pair%hamaker_constant = first_set(given%hamaker_constant, pair%hamaker_constant)
          pair%cohesion_energy = first_set(given%cohesion_energy, pair%cohesion_energy)
        end associate
      end do
    end if
    call scale_pair(contact, pair)
  end function pair_of

  !> Between a parcel of material a and a wall of material b.
  pure function wall_pair_of(contact, a, b) result(pair)
    type(contact_settings_t), intent(in) :: contact
    integer, intent(in) :: a, b  !< places of the materials, 0: none
    type(pair_t) :: pair

    type(material_settings_t) :: one

    if (b > 0) then
      pair = pair_of(contact, a, b)
      return
    end if
    one = properties(contact, a)
    pair%one = elastic_t(one%youngs_modulus, one%poisson_ratio)
    pair%other = elastic_t(first_set(contact%wall_youngs_modulus, one%youngs_modulus), &
                           first_set(contact%wall_poisson_ratio, one%poisson_ratio))
    pair%stiffness = first_set(contact%wall_stiffness, one%stiffness)
    pair%restitution = first_set(contact%wall_restitution, one%restitution)
    pair%friction = first_set(contact%wall_friction, one%friction)
    pair%tangential_ratio = contact%tangential_ratio
    pair%tangential_damping_ratio = contact%tangential_damping_ratio
    pair%rolling_friction = first_set(contact%wall_rolling_friction, one%rolling_friction)
    pair%rolling_damping = one%rolling_damping
    pair%hamaker_constant = first_set(contact%wall_hamaker_constant, one%hamaker_constant)
    pair%cohesion_energy = first_set(contact%wall_cohesion_energy, one%cohesion_energy)
    call scale_pair(contact, pair)
  end function wall_pair_of

  !> All properties of a material: its own, or those of &contact.
  pure function properties(contact, m) result(material)
    type(contact_settings_t), intent(in) :: contact
    integer, intent(in) :: m
    type(material_settings_t) :: material

    if (m > 0) material = contact%materials(m)
    material%stiffness = first_set(material%stiffness, contact%stiffness)
    material%youngs_modulus = first_set(material%youngs_modulus, contact%youngs_modulus)
    material%poisson_ratio = first_set(material%poisson_ratio, contact%poisson_ratio)
    material%restitution = first_set(material%restitution, contact%restitution)
    material%friction = first_set(material%friction, contact%friction)
    material%rolling_friction = first_set(material%rolling_friction, contact%rolling_friction)
    material%rolling_damping = first_set(material%rolling_damping, contact%rolling_damping)
    material%hamaker_constant = first_set(material%hamaker_constant, contact%hamaker_constant)
    material%cohesion_energy = first_set(material%cohesion_energy, contact%cohesion_energy)
  end function properties

  pure function first_set(key, default)
    real(wp), intent(in) :: key, default
    real(wp) :: first_set

    first_set = merge(key, default, is_set(key))
  end function first_set

  !> 2 a b/(a + b); exactly a of equals, and the same in either order. Unset if one is.
  pure function springs_in_series(a, b) result(k)
    real(wp), intent(in) :: a, b
    real(wp) :: k

    k = min(a, b)
    if (is_set(k)) k = 2*(k/(a + b))*max(a, b)
  end function springs_in_series

  !> sqrt(a b); exactly a of equals. Unset if one is.
  pure function geometric_mean(a, b) result(mean)
    real(wp), intent(in) :: a, b
    real(wp) :: mean

    mean = min(a, b)
    if (is_set(mean)) mean = sqrt(a*b)
  end function geometric_mean

  !> From the contacts of particles to those of parcels, if &contact asks for it: see coarse_graining.
  pure subroutine scale_pair(contact, pair)
    type(contact_settings_t), intent(in) :: contact
    type(pair_t), intent(inout) :: pair

    if (.not. is_set(contact%coarseness)) return
    if (contact%stiffness_scaling == 'constant_modulus') pair%stiffness = contact%coarseness*pair%stiffness
    if (contact%restitution_scaling == 'dissipation') pair%restitution = scaled_restitution(contact%coarseness, pair%restitution)
    if (contact%cohesion_scaling /= 'bond_number') return
    if (is_set(pair%hamaker_constant)) pair%hamaker_constant = contact%coarseness**2*pair%hamaker_constant
    if (is_set(pair%cohesion_energy)) pair%cohesion_energy = contact%coarseness**(1.0_wp/3.0_wp)*pair%cohesion_energy
  end subroutine scale_pair

  !> e_cg for parcels l times as wide as their particles: see coarse_graining. NaN where there is none.
  elemental function scaled_restitution(l, restitution) result(scaled)
    real(wp), intent(in) :: l, restitution  !< [-], [-]
    real(wp) :: scaled

    scaled = sqrt(1 - l*(1 - restitution**2))
  end function scaled_restitution

  !> Whether two pairs have the same properties.
  pure function is_alike(a, b)
    type(pair_t), intent(in) :: a, b
    logical :: is_alike

    is_alike = .not. any(abs(numbers(a) - numbers(b)) > 0.0_wp)
  end function is_alike

  pure function numbers(pair)
    type(pair_t), intent(in) :: pair
    real(wp) :: numbers(13)

    numbers = [pair%stiffness, pair%one%modulus, pair%one%poisson, pair%other%modulus, pair%other%poisson, pair%restitution, &
               pair%friction, pair%tangential_ratio, pair%tangential_damping_ratio, pair%rolling_friction, pair%rolling_damping, &
               pair%hamaker_constant, pair%cohesion_energy]
  end function numbers

end module contact_pairs
